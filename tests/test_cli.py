import csv
import os
import re
import subprocess
import sys

import pytest
import xarray as xr

from contactstudy.cli import main
from tests.small_study import BASE, format_toml, small_study
from tests.stand_in_solver import FAILS, WRONG_FRICTION, solve_fake
from tests.study.conftest import ROOT


@pytest.fixture
def study_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "small.toml"
    path.write_text(format_toml(small_study()))
    return path


def run_command(*arguments):
    return main([str(argument) for argument in arguments], solver=solve_fake)


def run_study_file(study_file, *options):
    return run_command("run", study_file, "--workers", 0, "--no-figure", *options)


def test_run_prints_written_files(study_file, tmp_path, capsys):
    assert run_command("run", study_file, "--workers", 0) == 0
    output = capsys.readouterr().out
    folder = tmp_path / "results" / "small"
    assert "4 cases: 4 ok; 4 solved now" in output
    assert "1 netCDF file, " in output
    for name in ("summary.nc", "edge_effect.png"):
        assert f"wrote results/small/{name}" in output
        assert (folder / name).stat().st_size > 1000


def test_run_without_figure_writes_no_png(study_file, tmp_path, capsys):
    assert run_study_file(study_file, "--out", tmp_path / "here") == 0
    assert not (tmp_path / "here" / "edge_effect.png").exists()
    assert "png" not in capsys.readouterr().out


def test_failed_cases_return_code_1(study_file, capsys):
    study_file.write_text(format_toml(small_study(sweep={"e_over_a": [0, 1], "friction": [0, FAILS]})))
    assert run_study_file(study_file) == 1
    assert "failed: e_over_a=0 friction=0.66: WindowError: this friction fails" in capsys.readouterr().out
    assert run_command("status", "results/small") == 1
    assert run_command("rerun", "results/small", "--workers", 0, "--no-figure") == 1


def test_status_groups_equal_reasons(study_file, capsys):
    study_file.write_text(format_toml(small_study(sweep={"e_over_a": [0, 1, 2], "friction": [FAILS]})))
    run_study_file(study_file)
    capsys.readouterr()
    assert run_command("status", "results/small") == 1
    output = capsys.readouterr().out
    assert output.count("this friction fails") == 1
    assert "(and 2 more)" in output
    assert "every case: --all" in output
    run_command("status", "results/small", "--all")
    assert capsys.readouterr().out.count("this friction fails") == 3


def test_plan_solves_no_case(study_file, tmp_path, capsys):
    assert run_command("plan", study_file) == 0
    output = capsys.readouterr().out
    assert "4 missing" in output
    assert "e_over_a 2 x friction 2" in output
    assert not (tmp_path / "results").exists()


def test_plan_forecasts_new_cases(study_file, capsys):
    run_study_file(study_file)
    study_file.write_text(format_toml(small_study(sweep={"e_over_a": [0, 1, -9], "friction": [0, 0.1, 0.2]})))
    capsys.readouterr()
    assert run_command("plan", study_file, "--all") == 0
    output = capsys.readouterr().out
    for expected in ("4 ok", "2 missing", "3 skipped", "body length", "of one core for 2 cases"):
        assert expected in output


def test_skipped_cases_are_printed_with_reason(study_file, capsys):
    study_file.write_text(format_toml(small_study(sweep={"e_over_a": [0, -9], "friction": [0.1]})))
    reason = r"  skipped: .*e_over_a=-9 friction=0\.1: .*body length"
    run_arguments = ("run", study_file, "--workers", 0, "--no-figure")
    for arguments in (("plan", study_file), run_arguments, ("status", "results/small")):
        assert run_command(*arguments) == 0
        assert re.search(reason, capsys.readouterr().out), arguments[0]


def test_plan_groups_equal_reasons(study_file, capsys):
    study_file.write_text(format_toml(small_study(base=BASE | {"load": 3.0})))
    assert run_command("plan", study_file) == 2
    output = capsys.readouterr().out
    assert output.count("given as one of the three") == 1
    assert "(and 3 more)" in output
    assert run_command("run", study_file, "--workers", 0) == 2
    assert "no case that can be solved" in capsys.readouterr().err


def test_status_collect_and_export_of_complete_study(study_file, tmp_path, capsys):
    run_study_file(study_file)
    capsys.readouterr()
    assert run_command("status", "results/small") == 0
    assert "4 ok" in capsys.readouterr().out
    assert run_command("collect", "results/small", "--out", tmp_path / "all.nc") == 0
    with xr.open_dataset(tmp_path / "all.nc") as dataset:
        assert dataset["peak_pressure"].dims == ("e_over_a", "friction")
        assert (dataset["status"] == "ok").all()
    assert run_command("export", "results/small") == 0
    with open(tmp_path / "results" / "small" / "summary.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4
    assert float(rows[0]["peak_pressure [Pa]"]) > 1e9
    capsys.readouterr()
    assert run_command("export", "results/small", "--out", "-") == 0
    assert capsys.readouterr().out.startswith("e_over_a,friction,")


@pytest.mark.parametrize(
    ("content", "expected"),
    [("[sweep]\nfrictoin = [0]\n", "did you mean 'friction'"), ("name = ", "small.toml"), ("", "give it in base")],
)
def test_invalid_study_file_returns_code_2(study_file, capsys, content, expected):
    study_file.write_text(content)
    assert run_study_file(study_file) == 2
    assert expected in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [("status", "nowhere"), ("plan", "nothing.toml"), ()])
def test_usage_error_returns_code_2(tmp_path, monkeypatch, capsys, arguments):
    monkeypatch.chdir(tmp_path)
    assert run_command(*arguments) == 2


@pytest.mark.parametrize("arguments", [("fly",), ("run",), ("run", "a.toml", "--workers", "many")])
def test_invalid_arguments_return_code_2(arguments, capsys):
    with pytest.raises(SystemExit) as error:
        run_command(*arguments)
    assert error.value.code == 2


def test_negative_number_of_workers_returns_code_2(study_file, capsys):
    assert run_command("run", study_file, "--workers", -1) == 2
    assert "workers = -1" in capsys.readouterr().err


def test_program_error_is_raised(study_file):
    study_file.write_text(format_toml(small_study(sweep={"e_over_a": [0], "friction": [WRONG_FRICTION]})))
    with pytest.raises(ZeroDivisionError):
        run_study_file(study_file)


def test_version_is_printed(capsys):
    assert run_command("--version") == 0
    assert capsys.readouterr().out.startswith("contactstudy ")


@pytest.mark.system
def test_help_avoids_heavy_imports():
    code = (
        "import sys; sys.argv = ['contactstudy', '--help']\n"
        "from contactstudy.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "assert not {'numpy', 'xarray', 'dask', 'matplotlib', 'scipy'} & set(sys.modules)\n"
    )
    finished_process = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert finished_process.returncode == 0, finished_process.stderr
    assert "plan" in finished_process.stdout


@pytest.mark.system
@pytest.mark.parametrize(("output", "code"), [(">&-", 0), (">/dev/full", 2)])
def test_missing_or_full_output_leaves_no_traceback(output, code):
    process = subprocess.run(
        f"{sys.executable} -m contactstudy.cli plan studies/edge_effect.toml {output}",
        shell=True,
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert (process.returncode, "Traceback" in process.stderr) == (code, False)


@pytest.mark.system
def test_closed_output_pipe_returns_code_141(study_file, tmp_path):
    """Like `contactstudy ... | head -1`: there is no error text, and the command writes all files."""
    for arguments in (["run", str(study_file), "--workers", "0", "--no-figure"], ["status", "results/small", "--all"]):
        read_end, write_end = os.pipe()
        os.close(read_end)
        with os.fdopen(write_end, "w") as pipe_file:
            process = subprocess.run(
                [sys.executable, "-m", "tests.study.fake_run", *arguments],
                cwd=tmp_path,
                env=os.environ | {"PYTHONPATH": str(ROOT), "CONTACTSTUDY_TEST_SECONDS": "0"},
                stdout=pipe_file,
                stderr=subprocess.PIPE,
                text=True,
                check=False,
            )
        assert process.returncode == 141, process.stderr
        assert "Traceback" not in process.stderr
        assert "BrokenPipe" not in process.stderr
    assert (tmp_path / "results" / "small" / "summary.nc").exists()


def format_large_study(count):
    return format_toml(
        small_study(sweep={"e_over_a": [number / 100 for number in range(count)], "friction": [0.0, 0.1]})
    )


def test_many_cases_need_confirmation(study_file, capsys, monkeypatch):
    monkeypatch.setattr("contactstudy.cli.MANY_CASES", 10)
    study_file.write_text(format_large_study(5))
    for arguments in (("plan", study_file), ("run", study_file, "--workers", 0)):
        assert run_command(*arguments) == 2
        captured = capsys.readouterr()
        assert "small: 10 combinations" in captured.out
        assert "fewer than 10; or give --yes" in captured.err
    assert run_command("plan", study_file, "--yes") == 0
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    for reply, code in (("", 2), ("n", 2), ("y", 0)):
        monkeypatch.setattr("builtins.input", lambda question, reply=reply: reply)
        assert run_command("plan", study_file) == code


def test_oversized_study_raises(study_file, capsys):
    sweep = {
        "e_over_a": [number / 1000 for number in range(1001)],
        "friction": [number / 1000 for number in range(1000)],
    }
    study_file.write_text(format_toml(small_study(sweep=sweep)))
    assert run_command("plan", study_file, "--yes") == 2
    assert "1001000 combinations" in capsys.readouterr().err


def test_plan_of_two_thousand_cases_needs_no_confirmation(study_file, capsys):
    study_file.write_text(format_large_study(1000))
    assert run_command("plan", study_file) == 0
    assert capsys.readouterr().out.startswith("study small: 2000 combinations")


def test_special_characters_in_labels_are_escaped(study_file, tmp_path):
    names = ["=HYPERLINK(A1)", "$\\frac{$", "@sum"]
    profiles = [
        {"name": name, "kind": "tapered", "half_angle": 0.01 * number} for number, name in enumerate(names, start=1)
    ]
    study = small_study(sweep={"friction": [0.0], "profile": profiles, "e_over_a": [0.0]})
    rows = [
        f"[[sweep.profile]]\nname = '{row['name']}'\nkind = 'tapered'\nhalf_angle = {row['half_angle']}"
        for row in profiles
    ]
    del study.sweep["profile"]
    study_file.write_text("\n".join([format_toml(study), *rows]))
    assert run_command("run", study_file, "--workers", 0) == 0
    assert list((tmp_path / "results" / "small").glob("*.png"))
    assert run_command("export", "results/small") == 0
    with open(tmp_path / "results" / "small" / "summary.csv", newline="") as file:
        labels = [row["profile"] for row in csv.DictReader(file)]
    assert labels == ["'=HYPERLINK(A1)", "$\\frac{$", "'@sum"]


def test_non_netcdf_file_raises_package_error(tmp_path, capsys):
    (tmp_path / "s.toml").write_text("[base]")
    assert run_command("export", tmp_path / "s.toml") == 2
    errors = capsys.readouterr().err
    assert "this file is not netCDF" in errors
    assert "xarray" not in errors
