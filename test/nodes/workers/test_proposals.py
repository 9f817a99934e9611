"""What the estimator knows comes through a status as it was."""

from dataclasses import replace

import pytest

from trawl_ros.control.trial.records import Knowledge, Proposal, TrialTarget
from trawl_ros.core.errors import MessageError
from trawl_ros.nodes.workers.proposals import knowledge_status, read_knowledge

FIRST = Proposal(TrialTarget(port=495.0, starboard=500.0, speed=2.3), 14.5, 1.25, 0.03, 2e5, 210.5)
SECOND = replace(FIRST, target=TrialTarget(port=700.0, starboard=700.0, speed=1.9), rate=0.01)
KNOWLEDGE = Knowledge(4, {'C_x value': 0.25, 'C_x slope': 1.5}, 2, 0.375, (FIRST, SECOND))


def test_it_comes_through_as_it_was():
    assert read_knowledge([knowledge_status(KNOWLEDGE)]) == KNOWLEDGE
    assert read_knowledge([knowledge_status(Knowledge(windows=1))]) == Knowledge(windows=1)
    trouble = Knowledge(windows=1, trouble='nothing to divide by')
    assert read_knowledge([knowledge_status(trouble)]) == trouble
    assert read_knowledge([]) is None


@pytest.mark.parametrize(
    ('key', 'value', 'said'),
    [
        ('2 gain', None, 'proposal 2 lacks gain'),
        ('windows', 'many', "windows is 'many'"),
        ('1 tension', 'nan', "1 tension is 'nan'"),
    ],
)
def test_what_is_no_number_or_missing_is_refused_by_name(key, value, said):
    status = knowledge_status(KNOWLEDGE)
    values = {name: text for name, text in status.values.items() if name != key}
    values |= {} if value is None else {key: value}
    with pytest.raises(MessageError, match=said):
        read_knowledge([replace(status, values=values)])
