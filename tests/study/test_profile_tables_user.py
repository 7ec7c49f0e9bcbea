"""User profiles in a study: identities, workers, files, and invalid profiles."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from contactstudy import InvalidInputError, profiles
from contactstudy.analysis import solved_case
from contactstudy.study import Study, load_case, open_study, run_study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.folder import Folder
from contactstudy.study.profile_tables import REGISTRY, profile_table
from tests.small_study import BASE, case_id, small_study
from tests.stand_in_solver import solve_fake


@dataclass(frozen=True)
class Cosine(profiles.Shape):
    depth: float
    waves: int = 1

    def drop(self, x, length):
        return self.depth * (1 - np.cos(self.waves * np.pi * x / length))


class Wedge:
    """Profile class that is neither a dataclass nor derived from a class."""

    def __init__(self, slope, **attributes):
        self.slope = slope
        self.__dict__ |= attributes

    def drop(self, x, length):
        return self.slope * np.abs(x)


def identity(profile: object) -> str:
    return case_id(BASE | {"e_over_a": 1, "profile": profile})


def test_user_profiles_differ_by_content() -> None:
    assert identity(Cosine(2e-6)) == identity(Cosine(2e-6, waves=1))
    user_profiles = [Cosine(2e-6), Cosine(3e-6), Cosine(2e-6, 3), Wedge(1e-4), Wedge(2e-4), Wedge(1e-4, note="worn")]
    user_profiles += [Cosine(2e-6) + profiles.Cylinder(1e-5), profiles.Halves(left=Wedge(1e-4), right=Cosine(2e-6))]
    assert len({identity(profile) for profile in user_profiles}) == len(user_profiles)


def test_changed_formula_changes_identity() -> None:
    class ChangingCosine(Cosine):
        def drop(self, x, length):
            return super().drop(x, length) + 1e-7 * (x / length) ** 4

    first_identity = identity(ChangingCosine(2e-6))
    ChangingCosine.drop = Cosine.drop
    assert identity(ChangingCosine(2e-6)) != first_identity


def test_case_keeps_unmodified_profile() -> None:
    wedge = Wedge(1e-4)
    study = small_study(base=BASE | {"e_over_a": 1.0, "profile": wedge}, sweep={"friction": [0.0]})
    wedge.slope = 5.0
    (case,) = study.plan()
    x = np.array([0.0, 1e-4])
    assert build_setup(case.parameters).case.roller.profile.drop(x, 1e-3).tolist() == [0.0, 1e-8]


@pytest.mark.system
def test_workers_solve_user_profile(tmp_path: Path) -> None:
    """The class is local to this function, so that a worker cannot import it."""

    class LocalWedge(Wedge):
        pass

    swept = {"profile": [LocalWedge(1e-4), Cosine(2e-6), "cylinder"], "friction": [0.0]}
    study = small_study(base=BASE | {"e_over_a": 1.0}, sweep=swept)
    assert run_study(study, tmp_path, workers=1, progress=False).counts == {"ok": 3}
    dataset = open_study(tmp_path)
    assert dataset.profile.values[1:].tolist() == ["Cosine(depth=2e-06, waves=1)", "cylinder"]
    assert dataset.profile.values[0].startswith("LocalWedge ")
    first_case = load_case(tmp_path, study.plan()[0].id)
    assert '"class": "LocalWedge", "values": {"slope": 0.0001}' in first_case.attrs["contactstudy_case"]
    drop = solved_case(first_case).roller.profile.drop(np.array([1e-4, 2e-4]), 0.5e-3)
    np.testing.assert_allclose(drop, [1e-8, 2e-8])


def test_run_without_user_profile_raises(tmp_path: Path, monkeypatch) -> None:
    study = small_study(base=BASE | {"e_over_a": 1.0, "profile": Wedge(1e-4)}, sweep={"friction": [0.0]})
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    for content in list(REGISTRY):
        monkeypatch.delitem(REGISTRY, content)
    assert open_study(tmp_path).status.values.tolist() == ["ok"]
    restored_study = Folder(tmp_path).read_study()
    assert run_study(restored_study, tmp_path, workers=0, progress=False).counts == {"ok": 1}
    with pytest.raises(InvalidInputError, match=r"profile = 'Wedge .*run the study from the script that makes this"):
        run_study(restored_study, tmp_path / "anew", workers=0, progress=False)


@pytest.mark.parametrize(
    ("profile", "message"),
    [
        (
            Wedge(1e-4, reader=open),
            "profile.reader = .*which identify .* not builtin_function.*; give its values",
        ),
        (Wedge(1e-4, lock={"inner": threading.Lock()}), "profile.lock.inner = .* not lock"),
        (Wedge(-1.0), "whose drop.* valid for a roller of 0.0001, .*it returned -"),
    ],
)
def test_profile_without_content_raises(profile: Wedge, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Study(name="refused", base={"profile": profile})


def test_unpicklable_profile_raises() -> None:
    class UnpicklableWedge(Wedge):
        def __reduce__(self):
            raise TypeError("bound to a file")

    with pytest.raises(
        InvalidInputError, match=r"'UnpicklableWedge': must be an object that can be pickled.*bound to a file.*list"
    ):
        Study(name="refused", base={"profile": UnpicklableWedge(1e-4)})


def test_profile_with_different_copy_raises() -> None:
    class WedgeWithoutSlope(Wedge):
        def __reduce__(self):
            return Wedge, (0.0,)

    with pytest.raises(InvalidInputError, match="its copy is another profile"):
        Study(name="refused", base={"profile": WedgeWithoutSlope(1e-4)})


def test_identity_depends_on_arrays_and_inner_profiles() -> None:
    points = np.linspace(0, 1, 200)
    assert identity(Wedge(1e-4, points=points)) != identity(Wedge(1e-4, points=points**2))
    assert identity(Wedge(1e-4, base=Cosine(1e-6))) != identity(Wedge(1e-4, base=Cosine(2e-6)))
    assert "200 values" in profile_table("profile", Wedge(1e-4, points=points))["values"]["points"]
