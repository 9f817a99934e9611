"""Matrix of Python versions: `nox` runs the quick tests on each, `nox -s tests` all but the long.

Each environment is made by the Makefile as `.venv` is, from the same lock. `nox --install-only`
makes them, after which `nox -R` needs no network.
"""

import nox

PYTHONS = ('3.11', '3.12', '3.13')

nox.needs_version = '>=2024.10.9'
nox.options.default_venv_backend = 'uv'
nox.options.download_python = 'never'
nox.options.reuse_venv = 'yes'
nox.options.sessions = ['quick']


def make(session: nox.Session, target: str) -> None:
    """Run a target of the Makefile in the environment of a session."""
    venv = f'VENV={session.virtualenv.location}'
    session.install('pip')
    session.run_install('make', venv, f'{session.virtualenv.location}/ready', external=True)
    session.run('make', venv, target, *session.posargs, external=True)


@nox.session(python=PYTHONS)
def quick(session: nox.Session) -> None:
    """Run the tests of `make check`."""
    make(session, 'quick')


@nox.session(python=PYTHONS)
def tests(session: nox.Session) -> None:
    """Run the tests of `make test`."""
    make(session, 'tests')
