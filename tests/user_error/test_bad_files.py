"""Files that are missing, broken, or no case at all."""

import os

import pytest

from rdpm.config.load import load_case
from rdpm.errors import CaseError


def refusal(source, overrides=()):
    with pytest.raises(CaseError) as refused:
        load_case(source, overrides)
    message = str(refused.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", ": must not be empty."),
        (b"\n \n", ": must not be empty."),
        (b"\x7fELF\0\0\1", ": must be a text file (it holds binary data)."),
        (b"\xff\xfea\n", ":1: must be UTF-8 text"),
        (b"title = 'a'\n\xe9\n", ":2: must be UTF-8 text"),
        (b"title = 'a'\n\ntitle = 'b'\n", ":3: must be TOML: "),
        (b"a = ", ":1: must be TOML: "),
    ],
)
def test_content(content, said, tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    assert refusal(path).startswith(f"{path}{said}")


def test_missing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert refusal("dktt") == 'dktt: there is no such file. Did you mean "dkt"?'
    assert "Shipped cases are:" in refusal("nothing-like-it.toml")
    assert "there is no such file" in refusal(tmp_path / "no" / "case.toml")
    assert "there is no such file" in refusal("a\0b")


def test_folder_and_device(tmp_path):
    assert "it is a folder" in refusal(tmp_path)
    (tmp_path / "case.toml").write_text("")
    assert f"Name the file {tmp_path / 'case.toml'}." in refusal(tmp_path)
    if os.path.exists("/dev/null"):
        assert "must be a regular file" in refusal("/dev/null")


def test_a_shipped_name_goes_before_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dkt").mkdir()  # what an earlier run left
    assert load_case("dkt").title


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "b.csv: must not be empty."),
        ("x_m,y_m,z_m\n", "b.csv: must have a line of column names, then a line a body."),
        ("x_m,y_m\n1,2\n", "b.csv:1: must have the column z_m."),
        ("x_m,y_m,z_m,u_m_s\n1,2,3,4\n", "b.csv:1: must have the column v_m_s."),
        ("x_m,y_m,z_m,z_m\n1,2,3,4\n", 'b.csv:1 = "z_m": must stand once.'),
        (
            "x_m,y_m,z_m,diameter\n1,2,3,4\n",
            'b.csv:1 = "diameter": unknown column. Did you mean "diameter_m"?',
        ),
        ("x_m,y_m,z_m\n1,2\n", "b.csv:2: must have 3 columns, not 2."),
        ("x_m,y_m,z_m\n1,2,three\n", 'b.csv:2: z_m = "three": must be a finite number in SI.'),
        ("x_m,y_m,z_m\n1,2,nan\n", 'b.csv:2: z_m = "nan": must be a finite number in SI.'),
        ('x_m,y_m,z_m\n1,2,"3\n', "b.csv: must be a CSV table"),
        (
            "x_m,y_m,z_m\n0,0.05,0.05\n",
            "b.csv:2: bodies[0].centers[0] = [0.0, 0.05, 0.05]: must lie inside the box",
        ),
        (
            "x_m,y_m,z_m,density_kg_m3\n1,2,3,-1\n",
            'case.toml:20: bodies[0].file = "b.csv": must not have the column',
        ),
    ],
)
def test_table_of_bodies(content, said, tmp_path, monkeypatch):
    from rdpm.cases import shipped_text

    monkeypatch.chdir(tmp_path)
    lines = [line for line in shipped_text("dkt").splitlines() if not line.startswith("centers")]
    text = "\n".join(lines).replace('density = "1120 kg/m^3"', 'density = 1120\nfile = "b.csv"')
    (tmp_path / "case.toml").write_text(text)
    (tmp_path / "b.csv").write_text(content)
    assert refusal("case.toml").startswith(said)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ('"no.csv"', "no.csv: there is no such file"),
        ("3", "--set bodies[0].file"),
        ('"b.csv"', "dkt.toml:21: bodies[0].file"),
    ],
)
def test_name_of_the_table(name, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    overrides = [f"bodies[0].file={name}"]
    if "no" in name:
        overrides.insert(0, "bodies=[{diameter=0.015, density=1120}]")
    assert refusal("dkt", overrides).startswith(said if "b.csv" not in name else "--set bodies[0].file")
