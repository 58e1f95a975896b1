"""One page for all tests of a process, as the toolkit has it; each test gets its own folder."""

import asyncio
import warnings
from contextlib import asynccontextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="the page's libraries are not installed: pip install 'rdpm[app]'")

TOKEN = "a-token-of-the-tests"
COOKIE = "rdpm_token"

_made = []


def _page():
    if not _made:
        from rdpm.app.launch import Launcher
        from rdpm.app.server import make_app
        from rdpm.app.settings import Settings
        from rdpm.app.workspace import Workspace

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of the toolkit's own libraries
            nothing = Workspace(Path(__file__).parent)  # until a test names its own
            _made.append(make_app(Settings(nothing, Launcher(nothing)), TOKEN, COOKIE))
    return _made[0]


@pytest.fixture
def page(tmp_path):
    """The application, working in a new folder."""
    from rdpm.app.launch import Launcher
    from rdpm.app.settings import Settings, use
    from rdpm.app.workspace import Workspace

    app = _page()
    root = tmp_path.resolve() / "work"
    root.mkdir()
    work = Workspace(root)
    launcher = Launcher(work)
    use(Settings(work, launcher))
    return SimpleNamespace(app=app, work=work, launcher=launcher, root=root)


@asynccontextmanager
async def visiting(page):
    """A browser's stand-in that knows the token."""
    import httpx
    from nicegui.testing import User

    inner = page.app.app
    async with inner.router.lifespan_context(inner):
        transport = httpx.ASGITransport(page.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://test", cookies={COOKIE: TOKEN}) as client:
            yield User(client)


@pytest.fixture
def visit(page):
    """Run a coroutine function with a visitor."""

    def run(act):
        async def whole():
            async with visiting(page) as user:
                return await act(user)

        return asyncio.run(whole())

    return run
