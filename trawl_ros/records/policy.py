"""Policy of a secured graph: the rights of all nodes as SROS 2 reads them.

The form is that of ``policy.xsd`` (0.2.0) of the package ``sros2``, which makes keys and
permissions from it: ``ros2 security generate_artifacts -k KEYSTORE -p policy.xml``.
"""

from xml.etree import ElementTree

from trawl_ros.records.rights import EVERY_NODE, SET_POINTS, Rights, enclaves
from trawl_ros.records.topics import NAMESPACE

VERSION = '0.2.0'
"""Version of the form."""


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
    root = ElementTree.Element('policy', version=VERSION)
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
    """Node that runs in an enclave: it has the enclave's name, but for set points."""
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
