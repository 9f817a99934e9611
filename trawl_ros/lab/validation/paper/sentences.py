# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All claims of section IV with the model's checks of them."""

from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.changes import Changes
from trawl_ros.lab.validation.paper.claim import claim_table
from trawl_ros.lab.validation.paper.claims_of_degrees import degree_claims
from trawl_ros.lab.validation.paper.claims_of_identification import identification_claims
from trawl_ros.lab.validation.paper.claims_of_installation import installation_claims
from trawl_ros.lab.validation.paper.claims_of_turned_boards import turned_board_claims
from trawl_ros.lab.validation.paper.comparison import compare_trial
from trawl_ros.lab.validation.paper.refit import refit_trial
from trawl_ros.lab.validation.paper.sweeps import FEW_TURNS, faster, installation_sweep, paper_model


def run(quick: bool) -> Findings:
    """Evaluate all claims."""
    model = paper_model(quick)
    changes = Changes(installation_sweep(model, FEW_TURNS), faster(model))
    claims = (
        *identification_claims(refit_trial(quick)),
        *installation_claims(changes),
        *turned_board_claims(changes),
        *degree_claims(compare_trial(quick)),
    )
    agree = sum(one.agrees == 'yes' for one in claims)
    return Findings(
        tuple(check for one in claims for check in one.checks),
        tables=(claim_table(claims),),
        text=(
            f'Of {len(claims)} sentences this model agrees with {agree} in full. Where the paper '
            'compares with its own sea trial or with tests of boards, which it does not print, '
            'the synthetic sample trial of this package and the coefficients that made it stand in.'
        ),
    )


CASE = ValidationCase('sentences', 'Sentences of section IV compared with this model', run)
