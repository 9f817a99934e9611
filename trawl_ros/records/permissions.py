# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rights of all nodes of a secured graph as files: policy, governance and permissions.

SROS 2 reads the policy, in the format of ``policy.xsd`` (0.2.0) of the package ``sros2``. It makes
keys and permissions from it: ``ros2 security generate_artifacts -k KEYSTORE -p policy.xml``.

The middleware reads governance and permissions (OMG's DDS Security 1.1, 9.4). SROS 2 makes
equivalent files from the policy. Written separately, they can be checked before they are signed,
and signed without SROS 2.
"""

from xml.etree import ElementTree

from trawl_ros.records.rights import EVERY_NODE, SET_POINTS, Rights, enclaves
from trawl_ros.records.topics import NAMESPACE

POLICY_VERSION = '0.2.0'
"""Version of the policy format."""

NOT_BEFORE, NOT_AFTER = '2026-01-01T00:00:00', '2036-01-01T00:00:00'
"""Times between which permissions hold; certificates have an end of their own."""

SCHEMA = 'http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_{}.xsd'
INSTANCE = '{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation'

GRAPH = 'ros_discovery_info'
"""DDS topic on which each process announces the nodes in it."""

DOMAIN_RULE = {
    'allow_unauthenticated_participants': 'false',
    'enable_join_access_control': 'true',
    'discovery_protection_kind': 'ENCRYPT',
    'liveliness_protection_kind': 'ENCRYPT',
    'rtps_protection_kind': 'SIGN',
}
TOPIC_RULE = {
    'topic_expression': '*',
    'enable_discovery_protection': 'true',
    'enable_liveliness_protection': 'true',
    'enable_read_access_control': 'true',
    'enable_write_access_control': 'true',
    'metadata_protection_kind': 'ENCRYPT',
    'data_protection_kind': 'ENCRYPT',
}
"""Rules of the domain and of every topic, as SROS 2 requires them."""

NAMES = {
    'publish': (('publish', 'rt{}'),),
    'subscribe': (('subscribe', 'rt{}'),),
    'reply': (('publish', 'rr{}Reply'), ('subscribe', 'rq{}Request')),
    'request': (('publish', 'rq{}Request'), ('subscribe', 'rr{}Reply')),
}
"""DDS names that a ROS right needs, by kind of right."""


def policy(namespace: str = NAMESPACE) -> str:
    """Write the policy of all nodes in a namespace, each with an enclave of its own.

    Parameters
    ----------
    namespace
        Of the nodes, without slashes at its ends. The enclave of a node is its full name.

    Returns
    -------
    str
        XML, one line for each topic or service.
    """
    root = ElementTree.Element('policy', version=POLICY_VERSION)
    every = ElementTree.SubElement(root, 'enclaves')
    for name, rights in enclaves().items():
        enclave = ElementTree.SubElement(every, 'enclave', path=f'/{namespace}/{name}')
        profiles = ElementTree.SubElement(enclave, 'profiles')
        node = node_of(name)
        profile = ElementTree.SubElement(profiles, 'profile', ns=f'/{namespace}', node=node)
        for what, kind, names in granted(rights):
            listed = ElementTree.SubElement(profile, f'{what}s', {kind: 'ALLOW'})
            for name in sorted(set(names)):
                ElementTree.SubElement(listed, what).text = name
    ElementTree.indent(root)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<!-- Rights of each node, written by `trawl policy`. -->\n'
        f'{ElementTree.tostring(root, encoding="unicode")}\n'
    )


def node_of(enclave: str) -> str:
    """Node that runs in an enclave: that of the enclave's name, except for set points."""
    return 'nmea_in' if enclave == SET_POINTS else enclave


def granted(rights: Rights) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return element, attribute and names of each list that is not empty."""
    lists = [
        ('topic', 'publish', (*EVERY_NODE.publishes, *rights.publishes)),
        ('topic', 'subscribe', (*EVERY_NODE.hears, *rights.hears)),
        ('service', 'reply', (*EVERY_NODE.answers, *rights.answers)),
        ('service', 'request', rights.calls),
    ]
    return [entry for entry in lists if entry[2]]


def security_files(namespace: str = NAMESPACE, domain: int = 0) -> dict[str, str]:
    """Write what secures a graph: policy, governance and the permissions of each enclave.

    Parameters
    ----------
    namespace
        Of the nodes, without slashes at its ends.
    domain
        ``ROS_DOMAIN_ID`` of the graph.

    Returns
    -------
    dict
        Texts by the path of the file.
    """
    files = {'policy.xml': policy(namespace), 'governance.xml': governance(domain)}
    for name, rights in enclaves().items():
        files[f'permissions/{name}.xml'] = permissions(name, rights, namespace, domain)
    return files


def governance(domain: int = 0) -> str:
    """Return the governance file of a domain: nodes need a key, and all traffic is encrypted."""
    root = _root('governance')
    rule = ElementTree.SubElement(
        ElementTree.SubElement(root, 'domain_access_rules'), 'domain_rule'
    )
    _domains(rule, domain)
    _fill(rule, DOMAIN_RULE)
    topics = ElementTree.SubElement(rule, 'topic_access_rules')
    _fill(ElementTree.SubElement(topics, 'topic_rule'), TOPIC_RULE)
    return _text(root)


def permissions(name: str, rights: Rights, namespace: str = NAMESPACE, domain: int = 0) -> str:
    """Write the permissions of an enclave: a grant of its rights, all else being denied.

    Parameters
    ----------
    name
        Of the enclave, in the namespace.
    rights
        Beyond those of every node.
    namespace
        Of the nodes, without slashes at its ends.
    domain
        ``ROS_DOMAIN_ID`` of the graph.
    """
    path = f'/{namespace}/{name}'
    topics = {'publish': {GRAPH}, 'subscribe': {GRAPH}}
    for _, kind, names in granted(rights):
        for way, form in NAMES[kind]:
            topics[way] |= {form.format(_full(text, name, namespace)) for text in names}
    root = _root('permissions')
    grant = ElementTree.SubElement(
        ElementTree.SubElement(root, 'permissions'), 'grant', {'name': path}
    )
    _fill(grant, {'subject_name': f'CN={path}'})
    validity = ElementTree.SubElement(grant, 'validity')
    _fill(validity, {'not_before': NOT_BEFORE, 'not_after': NOT_AFTER})
    allowed = ElementTree.SubElement(grant, 'allow_rule')
    _domains(allowed, domain)
    for way, found in topics.items():
        listed = ElementTree.SubElement(ElementTree.SubElement(allowed, way), 'topics')
        for topic in sorted(found):
            _fill(listed, {'topic': topic})
    _fill(grant, {'default': 'DENY'})
    return _text(root)


def _full(name: str, enclave: str, namespace: str) -> str:
    """Full name of a topic or service of the node in an enclave."""
    if name.startswith('/'):
        return name
    return f'/{namespace}/{name.replace("~", node_of(enclave), 1)}'


def _root(form: str) -> ElementTree.Element:
    return ElementTree.Element('dds', {INSTANCE: SCHEMA.format(form)})


def _domains(rule: ElementTree.Element, domain: int) -> None:
    _fill(ElementTree.SubElement(rule, 'domains'), {'id': str(domain)})


def _fill(element: ElementTree.Element, values: dict[str, str]) -> None:
    for name, value in values.items():
        ElementTree.SubElement(element, name).text = value


def _text(root: ElementTree.Element) -> str:
    ElementTree.register_namespace('xsi', 'http://www.w3.org/2001/XMLSchema-instance')
    ElementTree.indent(root)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<!-- Written by `trawl policy`. -->\n'
        f'{ElementTree.tostring(root, encoding="unicode")}\n'
    )
