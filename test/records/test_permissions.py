"""Governance and permissions say in DDS what the policy says in ROS, and can be signed."""

import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from trawl_ros.cli.policy import command
from trawl_ros.core.resources import share_path
from trawl_ros.records.permissions import GRAPH, security_files
from trawl_ros.records.rights import OPERATOR, SET_POINTS, enclaves

GUIDE = Path(__file__).parents[2] / 'docs' / 'guides' / 'security.md'
COMMANDING = {'autotrawl_node', 'autopilot_node', 'trial_node', SET_POINTS, OPERATOR}


def topics(text: str, way: str) -> set[str]:
    """Names that permissions allow in a way."""
    found = ElementTree.fromstring(text).iterfind(f'.//allow_rule/{way}/topics/topic')
    return {str(topic.text) for topic in found}


def test_the_command_writes_policy_governance_and_permissions(tmp_path: Path) -> None:
    out = tmp_path / 'security'
    assert CliRunner().invoke(command, ['--out', str(out)]).exit_code == 0
    written = {str(path.relative_to(out)): path.read_text() for path in out.rglob('*.xml')}
    assert written == security_files()
    assert written['policy.xml'] == share_path('config', 'sros2', 'policy.xml').read_text()
    again = CliRunner().invoke(command, ['--out', str(out)])
    assert 'exists already' in str(again.exception)


def test_nobody_joins_without_a_key_and_everything_is_encrypted() -> None:
    root = ElementTree.fromstring(security_files(domain=7)['governance.xml'])
    rule = root.find('domain_access_rules/domain_rule')
    # The order is that of the schema.
    assert rule is not None
    assert [part.tag for part in rule] == [
        'domains',
        'allow_unauthenticated_participants',
        'enable_join_access_control',
        'discovery_protection_kind',
        'liveliness_protection_kind',
        'rtps_protection_kind',
        'topic_access_rules',
    ]
    assert rule.findtext('domains/id') == '7'
    assert rule.findtext('allow_unauthenticated_participants') == 'false'
    assert rule.findtext('enable_join_access_control') == 'true'
    (topic,) = rule.iterfind('topic_access_rules/topic_rule')
    said = {part.tag: part.text for part in topic}
    assert said.pop('topic_expression') == '*'
    assert set(said.values()) == {'true', 'ENCRYPT'}


@pytest.mark.parametrize('name', enclaves())
def test_an_enclave_has_one_grant_and_all_else_is_denied(name: str) -> None:
    text = security_files('fleet/one', 3)[f'permissions/{name}.xml']
    (grant,) = ElementTree.fromstring(text).iterfind('permissions/grant')
    assert grant.get('name') == f'/fleet/one/{name}'
    assert [part.tag for part in grant] == ['subject_name', 'validity', 'allow_rule', 'default']
    assert grant.findtext('subject_name') == f'CN=/fleet/one/{name}'
    assert grant.findtext('default') == 'DENY'
    assert grant.findtext('allow_rule/domains/id') == '3'
    for way in ('publish', 'subscribe'):
        for topic in topics(text, way) - {GRAPH}:
            assert re.fullmatch(r'rt(/\w+)+|rq(/\w+)+Request|rr(/\w+)+Reply', topic)


def test_commands_are_written_by_those_who_may() -> None:
    files = security_files()
    may = {
        name
        for name in enclaves()
        if any('/command/' in t for t in topics(files[f'permissions/{name}.xml'], 'publish'))
    }
    assert may == COMMANDING


def test_services_are_answered_by_their_node_and_called_by_an_operator() -> None:
    files = security_files()
    answers = files['permissions/sim_node.xml']
    calls = files[f'permissions/{OPERATOR}.xml']
    for service in ('/trawl/pause', '/trawl/sim_node/set_parameters'):
        request, reply = f'rq{service}Request', f'rr{service}Reply'
        assert request in topics(answers, 'subscribe') - topics(answers, 'publish')
        assert reply in topics(answers, 'publish') - topics(answers, 'subscribe')
        assert request in topics(calls, 'publish')
        assert reply in topics(calls, 'subscribe')


@pytest.mark.skipif(not shutil.which('openssl'), reason='needs openssl')
def test_the_guide_signs_them_so_that_openssl_verifies_them(tmp_path: Path) -> None:
    script = re.search(r'```bash sign\.sh\n(.*?)```', GUIDE.read_text(), re.DOTALL)
    assert script
    (tmp_path / 'sign.sh').write_text(script[1])
    for name, text in security_files().items():
        path = tmp_path / 'security' / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    keystore = tmp_path / 'keystore'
    for name in ('public', 'private', *(f'enclaves/trawl/{name}' for name in enclaves())):
        (keystore / name).mkdir(parents=True)
    key = keystore / 'private' / 'permissions_ca.key.pem'
    certificate = keystore / 'public' / 'permissions_ca.cert.pem'
    run(
        'openssl', 'req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1',
        '-nodes', '-subj', '/CN=sros2CA', '-keyout', str(key), '-out', str(certificate),
    )  # fmt: skip
    run('bash', 'sign.sh', cwd=tmp_path)
    signed = {
        keystore / 'enclaves' / 'governance.p7s': 'governance.xml',
        **{
            keystore / 'enclaves' / 'trawl' / name / 'permissions.p7s': f'permissions/{name}.xml'
            for name in enclaves()
        },
    }
    for path, name in signed.items():
        said = run(
            'openssl', 'smime', '-verify', '-text', '-in', str(path), '-CAfile', str(certificate)
        )
        assert said.split() == (tmp_path / 'security' / name).read_text().split()


def run(*command: str, cwd: Path | None = None) -> str:
    """Run a command, and return what it prints."""
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True).stdout
