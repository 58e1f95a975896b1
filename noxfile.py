"""Development tasks: ``nox -s lint``, ``nox -s tests``, ``nox -s full``, ``nox -s docs``."""

import nox

nox.options.default_venv_backend = "venv"
nox.options.sessions = ["lint", "tests"]

SOURCES = ("src", "tests", "benchmarks", "docs", "noxfile.py", ".ci")


@nox.session
def lint(session: nox.Session) -> None:
    """Style, types, import contracts, C++ format."""
    session.install(".[lint,app]")
    session.run("ruff", "check", *SOURCES)
    session.run("mypy", "-p", "rdpm")  # as installed, with the stub of _core
    session.run("mypy", "tests/types")
    session.run("lint-imports")
    session.run("python", ".ci/cpp_format.py")


@nox.session
def tests(session: nox.Session) -> None:
    """Run the quick tier, as the continuous integration does."""
    session.install(".[test]")
    session.run("python", "-m", "pytest", *session.posargs)


@nox.session
def full(session: nox.Session) -> None:
    """Everything, the long cases included."""
    session.install(".[test]")
    session.run("python", "-m", "pytest", "-m", "full or not full", *session.posargs)


@nox.session
def mutations(session: nox.Session) -> None:
    """A hundred thousand spoiled case files, each accepted or refused with one message."""
    session.install(".[test]")
    session.run("python", "-m", "pytest", "tests/user_error/test_mutated_cases.py", env={"RDPM_MUTATIONS": "100000"})


@nox.session(python=["3.11", "3.12", "3.13", "3.14"])
def pythons(session: nox.Session) -> None:
    """Run the quick tier under every Python that is found here."""
    session.install(".[test]")
    session.run("python", "-m", "pytest", "-n", "auto", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Build the documentation; a warning is an error."""
    session.install(".[docs]")
    session.run("sphinx-build", "-W", "-b", "html", "docs", "docs/_build/html")


@nox.session
def edits(session: nox.Session) -> None:
    """Single edits of the coupled step: each must make a test fail. Once a release."""
    session.install(".[test]")
    session.run("python", ".ci/edits.py", *session.posargs)
