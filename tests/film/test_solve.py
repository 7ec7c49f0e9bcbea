"""The film of cases: certificate, limits, ends, rejected input."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import contactstudy as cs
from contactstudy import InvalidInputError
from contactstudy.film import Asperities, FilmResolution, solve_film
from contactstudy.film.levels import RESOLUTION, moes_line
from contactstudy.film.line_contact import solve_line
from contactstudy.film.solve import MIN_RELATIVE_ERROR, _estimate_errors, _find_minimum

pytestmark = pytest.mark.filterwarnings("ignore::contactstudy.MagnitudeWarning")

STEEL = cs.Material(210e9, 0.3)
HALF_WIDTH, RADIUS = 65e-6, 5e-3
PRESSURE = HALF_WIDTH * STEEL.plane_strain_modulus / (2 * RADIUS)


def oil_of(case, load, lubricant, speed=1.0):
    """Return Barus' oil of constant density for Moes' numbers of a case."""
    modulus = 2 * case.modulus
    root = case.normal_load / (case.contact_length * modulus * RADIUS * load)
    return cs.Lubricant(
        viscosity=0.5 * root**2 * modulus * RADIUS / speed,
        pressure_viscosity=lubricant / (modulus * root**0.5),
        viscosity_law="barus",
        density_law="constant",
    )


def film_case(length, load=20.0, lubricant=10.0, *, body=None, profile=None, speed=1.0, end_distance=None):
    roller = cs.Roller(radius=RADIUS, length=length, profile=profile or cs.profiles.Cylinder())
    body = cs.FiniteLengthSpace(length=length, material=STEEL) if body is None else body
    case = cs.Case(body=body, roller=roller, max_pressure=PRESSURE, end_distance=end_distance)
    motion = cs.Sliding(body_speed=speed, roller_speed=speed)
    return replace(case, lubricant=oil_of(case, load, lubricant, abs(speed)), motion=motion)


COARSE = replace(
    RESOLUTION, finest=1.1, finest_share=0.24, inner=0.32, inner_inlet=5, growth=0.2, columns=0.24, columns_inlet=0.8
)
LENGTH = 6 * HALF_WIDTH
CROWN = cs.profiles.Lundberg(amplitude=HALF_WIDTH**2 / (4 * RADIUS))


def coarse_film(case, **arguments):
    return solve_film(case, accuracy=0.2, resolution=COARSE, **arguments)


@pytest.fixture(scope="module")
def crowned():
    return coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN))


def test_certificate_is_small(crowned):
    assert bool(crowned.converged)
    assert float(crowned.mass_error) < 1e-6
    assert float(crowned.film_balance_error) < 1e-6
    assert float(crowned.film_load_error) < 1e-8
    assert float(crowned.film_complementarity_error) < 1e-6


def test_pressure_carries_the_load(crowned):
    dy = float(crowned.y[1] - crowned.y[0])
    load = float((crowned.pressure * crowned.x_width).sum() * dy)
    assert load == pytest.approx(float(crowned.normal_load), rel=1e-9)
    assert float(crowned.pressure.min()) >= 0.0


def test_symmetric_roller_has_a_symmetric_film(crowned):
    assert float(crowned.least_film_first) == pytest.approx(float(crowned.least_film_last), rel=1e-3)
    assert float(crowned.least_film_first_x + crowned.least_film_last_x) == pytest.approx(LENGTH, rel=1e-3)


def test_film_at_half_space_ends_is_thinner(crowned):
    body = cs.HalfSpace(material=STEEL)
    half_space_film = coarse_film(film_case(LENGTH, 10.0, 5.0, body=body, profile=CROWN))
    assert float(half_space_film.least_film) < 0.6 * float(crowned.least_film)
    assert float(half_space_film.central_film) == pytest.approx(float(crowned.central_film), rel=0.05)


def test_mid_length_film_equals_a_line_contact():
    case = film_case(100 * HALF_WIDTH, profile=CROWN, body=cs.HalfSpace(material=STEEL))
    film = coarse_film(case)
    scale = RADIUS * np.sqrt(2 * case.lubricant.viscosity / (2 * case.modulus * RADIUS))
    line = solve_line(float(film.moes_load), float(film.moes_lubricant), finest=0.1)
    error = float(film.central_film_error) + 5e-3 * float(film.central_film)
    assert abs(float(film.central_film) - line.central_film * scale) < error
    middle = float(film.slice_film.sel(x=50 * HALF_WIDTH, method="nearest"))
    assert middle == pytest.approx(line.central_film * scale, rel=0.04)


@pytest.mark.slow
def test_face_film_of_flush_rollers_has_converged():
    case = film_case(4 * HALF_WIDTH, 10.0, 5.0)
    cells = (replace(COARSE, columns=0.12 * factor, columns_inlet=0.4 * factor) for factor in (1.0, 0.5))
    film, narrower = (solve_film(case, accuracy=0.2, resolution=resolution) for resolution in cells)
    assert float(film.least_film_first_x) == pytest.approx(0.0, abs=1e-12)
    assert float(film.least_film_first) < 0.8 * float(film.least_film_middle)
    difference = abs(float(film.least_film_first - narrower.least_film_first))
    assert difference < float(film.least_film_first_error) < 0.04 * float(film.central_film)


@pytest.mark.slow
def test_tilted_roller_has_minimum_film_at_its_end():
    """On the first columns the film seven half-widths from the end is thinner than at the end."""
    crown = cs.profiles.PartialCrown(straight_length=2.315e-3, crown_radius=97.95e-3)
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=3.623e-3, material=STEEL),
        roller=cs.Roller(radius=RADIUS, length=3.541e-3, profile=crown, material=STEEL),
        end_distance=40.966e-6,
        tilt=-0.1101e-3,
        max_pressure=1.0003e9,
        lubricant=cs.Lubricant(
            viscosity=0.05, pressure_viscosity=19.2e-9, viscosity_law="barus", density_law="constant"
        ),
        motion=cs.Sliding(body_speed=0.30132, roller_speed=0.30132),
    )
    film = solve_film(case, accuracy=0.02)
    assert float(film.least_film_x) < 1.2 * float(film.hertz_half_width)
    # Cells of a quarter of the width along y and half the width along x result in 93.97 nm.
    assert float(film.least_film) == pytest.approx(93.97e-9, abs=float(film.least_film_error))


def test_films_evaluate_the_reference_lines_on_the_finest_cells_only():
    """The coarser levels have the motion of the reference lines of the dry contact."""
    cs.cache.clear()
    film = coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN))
    assert int(film.film_levels) > 2
    assert cs.cache.info().kinds["reference lines"].computed == 2


def test_slice_films_miss_the_end_closure(crowned):
    case = replace(film_case(LENGTH, 10.0, 5.0, profile=CROWN), lubricant=None, motion=cs.Sliding())
    dry = cs.solve(case, accuracy=0.05, stresses=False)
    load = dry.pressure.sum("y") * float(dry.y[1] - dry.y[0])
    root = np.sqrt(2 * oil_of(case, 10.0, 5.0).viscosity / (2 * case.modulus * RADIUS))
    for x in (3 * HALF_WIDTH, HALF_WIDTH):
        load_number = float(load.sel(x=x, method="nearest")) / (2 * case.modulus * RADIUS * root)
        expected = moes_line(load_number, 5.0) * RADIUS * root
        assert float(crowned.slice_film.sel(x=x, method="nearest")) == pytest.approx(float(expected), rel=1e-2)
    assert float(crowned.slice_film.min()) > 1.5 * float(crowned.least_film)
    assert crowned.slice_film.attrs["error_kind"] == "not estimated"


def test_reversed_surfaces_mirror_the_film(crowned):
    mirrored = coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN, speed=-1.0))
    assert float(mirrored.least_film_y) == pytest.approx(-float(crowned.least_film_y), rel=1e-6)
    assert mirrored.film_thickness.values[:, ::-1] == pytest.approx(crowned.film_thickness.values, rel=1e-6)
    speed_flow = crowned.film_thickness.max()
    for name, sign in (("flow_x", 1), ("flow_y", -1)):
        expected = sign * crowned[name].values
        assert mirrored[name].values[:, ::-1] == pytest.approx(expected, abs=1e-6 * float(speed_flow), nan_ok=True)
    assert float(mirrored.end_flow_last) == pytest.approx(float(crowned.end_flow_last), rel=1e-5)


@pytest.mark.parametrize(("speed", "growth"), [pytest.param(1.2, 1.0, marks=pytest.mark.slow), (0.9, 1.1)])
def test_next_speed_has_the_cells_and_errors_of_the_previous_film(crowned, speed, growth):
    """The stated errors grow for a thinner film; they cover the film that is refined anew."""
    case = film_case(LENGTH, 10.0, 5.0, profile=CROWN)
    next_case = replace(case, motion=cs.Sliding(body_speed=speed, roller_speed=speed))
    computed = cs.cache.info().kinds["surface operators"].computed
    warm = coarse_film(next_case, start=crowned)
    assert cs.cache.info().kinds["surface operators"].computed == computed
    cold = coarse_film(next_case)
    assert int(warm.film_levels) == 1
    assert int(warm.newton_steps) < 0.3 * int(cold.newton_steps)
    assert float(warm.mass_error) < 1e-6
    for name in ("central_film", "least_film", "least_film_last"):
        cell_errors = [float(film[f"{name}_error"] / film[name]) - MIN_RELATIVE_ERROR for film in (crowned, warm)]
        assert cell_errors[1] == pytest.approx(growth * cell_errors[0], rel=0.01)
        assert abs(float(warm[name] - cold[name])) < float(warm[f"{name}_error"])


def test_inaccurate_errors_refine_the_cells_of_the_previous_film_once(crowned):
    """The errors of second order on the next cells cover a film on finer cells."""
    speed = 0.8
    case = replace(film_case(LENGTH, 10.0, 5.0, profile=CROWN), motion=cs.Sliding(body_speed=speed, roller_speed=speed))
    names = ("central_film", "least_film", "least_film_middle")
    accuracy = max(float(crowned[f"{name}_error"] / crowned.central_film) for name in names)
    warm = solve_film(case, accuracy=accuracy, resolution=COARSE, start=crowned)
    assert int(warm.film_levels) == 1
    assert warm.pressure.size > crowned.pressure.size
    fine = solve_film(case, accuracy=0.2, resolution=RESOLUTION)
    for name in names:
        assert float(warm[f"{name}_error"]) <= accuracy * float(warm.central_film)
        assert abs(float(warm[name] - fine[name])) < float(warm[f"{name}_error"] + fine[f"{name}_error"])


def test_film_of_another_profile_is_refined_anew(crowned):
    deeper_crown = cs.profiles.Lundberg(amplitude=1.2 * CROWN.amplitude)
    other_case = film_case(LENGTH, 10.0, 5.0, profile=deeper_crown)
    refined = coarse_film(other_case, start=crowned)
    assert int(refined.film_levels) > 1
    assert float(refined.least_film) == pytest.approx(float(coarse_film(other_case).least_film), rel=1e-6)


@pytest.mark.parametrize(("tilt", "load_position"), [(1e-4, None), (0.0, 2.5 * HALF_WIDTH)])
def test_film_obeys_the_gap_equation_between_the_reference_lines(tilt, load_position):
    """The displacements come from the stress fields' operator, at the top and at the depth of the reference line."""
    case = replace(film_case(LENGTH, 10.0, 5.0, profile=CROWN), tilt=tilt, load_position=load_position)
    film = coarse_film(case)
    centre = case.roller_middle if load_position is None else load_position
    line = np.linspace(0.0, LENGTH, 201)
    x = film.x.values[[film.sizes["x"] // 3, film.sizes["x"] // 2]]
    top, deep = (
        cs.displacement_field(case.body, film.pressure, x=positions, y=[0.0], z=[depth]).u_z.values.ravel()
        for positions, depth in ((x, 0.0), (line, case.body.depth))
    )
    line_tilt, _ = np.polyfit(line, deep, 1)
    resultant = float(film.x.weighted(film.pressure.sum("y") * film.x_width).mean())
    line_level = np.interp(resultant, line, deep)
    drop = CROWN.drop(x - 0.5 * LENGTH, LENGTH)
    approach = float(film.approach) + float(film.tilt) * (x - centre)
    expected = drop + top - line_level - line_tilt * (x - resultant) - approach
    computed = film.film_thickness.sel(x=x).interp(y=0.0).values
    assert computed == pytest.approx(expected, abs=0.01 * float(film.central_film))
    assert load_position is not None or float(film.tilt) == tilt


@pytest.mark.parametrize("load_position", [None, 2.5 * HALF_WIDTH])
def test_approach_and_tilt_near_those_of_the_dry_contact(load_position):
    """The film separates the surfaces: its approach is less by about the central film."""
    case = replace(film_case(LENGTH, 60.0, 5.0, profile=CROWN), load_position=load_position)
    film, dry = coarse_film(case), cs.solve(replace(case, lubricant=None), accuracy=0.02, stresses=False)
    separation = float(dry.approach - film.approach)
    assert separation == pytest.approx(float(film.central_film), rel=0.1)
    assert separation < 0.03 * float(dry.approach)
    assert float(film.tilt) == pytest.approx(float(dry.tilt), rel=0.02, abs=1e-8)
    assert float(film.reference_depth) == float(dry.reference_depth)


def test_flows_balance_and_leave_through_both_ends(crowned):
    """Mass balance of the rectangle between the centres of the end columns, from the inlet to the middle."""
    inlet = crowned.sel(y=slice(-2.5 * HALF_WIDTH, 0.0))
    entered, left = (float(inlet.flow_y.isel(y=row).integrate("x")) for row in (0, -1))
    leaked = [sign * float(inlet.flow_x.isel(x=column).integrate("y")) for sign, column in ((-1, 0), (1, -1))]
    assert entered - left == pytest.approx(sum(leaked), rel=0.02)
    assert leaked[0] == pytest.approx(leaked[1], rel=1e-3)
    assert float(crowned.end_flow_first) == pytest.approx(float(crowned.end_flow_last), rel=1e-3)
    # In the middle of the contact the entrained film carries the flow.
    middle = crowned.sel(x=0.5 * LENGTH, method="nearest").sel(y=0.0, method="nearest")
    assert float(middle.flow_y) == pytest.approx(float(crowned.entrainment_speed * middle.film_thickness), rel=0.01)
    broken = crowned.film_thickness.notnull() & (crowned.pressure == 0)
    assert bool(crowned.flow_y.isnull().where(broken, True).all())
    assert crowned.flow_y.attrs["units"] == "m2 s-1"
    assert crowned.end_flow_last.attrs["units"] == "m3 s-1"


def test_film_near_the_edge_of_a_quarter_space_equals_that_between_distant_ends():
    """The second end, thirty half-widths away, has no influence."""
    length = 30 * HALF_WIDTH + LENGTH
    bodies = cs.QuarterSpace(material=STEEL), cs.FiniteLengthSpace(length=length, material=STEEL)
    films = [coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN, body=body, end_distance=0.0)) for body in bodies]
    for name in ("central_film", "least_film_first", "least_film_last"):
        assert float(films[0][name]) == pytest.approx(float(films[1][name]), rel=5e-3)
    assert float(films[0].least_film_last) < 0.9 * float(films[0].least_film_first)


def test_load_position_balances_the_pressure():
    position = 2.5 * HALF_WIDTH
    film = coarse_film(replace(film_case(LENGTH, 10.0, 5.0, profile=CROWN), load_position=position))
    resultant = float(film.x.weighted(film.pressure.sum("y") * film.x_width).mean())
    assert resultant == pytest.approx(position, abs=1e-6 * LENGTH)
    assert float(film.tilt) < 0.0
    assert float(film.least_film_first) < float(film.least_film_last)


def test_asperity_law_of_the_user_carries_its_pressure():
    stiffness = 1e8  # Pa

    def press(distance):
        return stiffness * np.exp(-distance / 1e-7)

    film = coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN), asperities=Asperities(rms=1e-7, pressure=press))
    distance = film.film_thickness.sel(x=0.5 * LENGTH, y=0.0, method="nearest")
    computed = float(film.asperity_pressure.sel(x=0.5 * LENGTH, y=0.0, method="nearest"))
    # The mean height of the film exceeds the distance of the mean planes.
    assert float(press(distance)) <= computed < 2 * float(press(distance))
    area = film.x_width * float(film.y[1] - film.y[0])
    share = float((film.asperity_pressure * area).sum() / film.normal_load)
    assert float(film.asperity_load_share) == pytest.approx(share, rel=1e-3)


def test_asperities_carry_part_of_the_load():
    rough = Asperities(rms=1e-7)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cs.ConvergenceWarning)
        mixed = coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN), asperities=rough)
    assert bool(mixed.converged)
    assert 0.0 < float(mixed.asperity_load_share) < 1.0
    assert float(mixed.film_thickness.min()) > 0.0
    assert bool((mixed.asperity_pressure <= mixed.pressure * (1 + 1e-9)).all())
    # A surface with a roughness equal to the film thickness has a viscosity ratio of 1.
    assert float(mixed.viscosity_ratio) == pytest.approx((float(mixed.least_film_middle) / 1e-7) ** 1.3)
    assert float(mixed.viscosity_ratio_error) > 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lubricant": None}, "lubricant"),
        ({"motion": cs.Sliding()}, "motion"),
        ({"motion": cs.Sliding(body_speed=1.0, roller_speed=-1.0)}, "motion"),
        ({"coupled": True, "friction": 0.1}, "coupled"),
    ],
)
def test_bad_case_is_rejected(changes, message):
    case = replace(film_case(16 * HALF_WIDTH), **changes)
    with pytest.raises(cs.InvalidInputError, match=message):
        solve_film(case)


def test_bad_argument_is_rejected():
    case = film_case(16 * HALF_WIDTH)
    with pytest.raises(cs.InvalidInputError, match="accuracy"):
        solve_film(case, accuracy=1e-5)
    with pytest.raises(cs.InvalidInputError, match="inlet"):
        solve_film(case, inlet=0.5 * HALF_WIDTH)
    with pytest.raises(cs.InvalidInputError, match="rms"):
        Asperities(rms=0.0)


@pytest.mark.slow
def test_thin_film_between_rough_surfaces_nears_the_dry_contact():
    case = film_case(LENGTH, 200.0, 5.0, profile=CROWN)
    film = coarse_film(case, asperities=Asperities(rms=5e-8))
    dry = cs.solve(replace(case, lubricant=None), accuracy=0.02, stresses=False)
    pressures = [result.pressure.interp(x=0.5 * LENGTH, y=0.0) for result in (film, dry)]
    assert float(film.asperity_load_share) > 0.1
    assert abs(float(pressures[0] - pressures[1])) < 0.005 * PRESSURE


@pytest.mark.parametrize(("name", "length"), [("inlet", 1.0), ("inlet", 200.0), ("outlet", 0.1), ("inlet", np.nan)])
def test_unsettled_window_raises(name: str, length: float) -> None:
    """An inlet of one inlet length would give two thirds of the film."""
    with pytest.raises(InvalidInputError, match=rf"^{name} = "):
        FilmResolution(**{name: length})
    with pytest.raises(InvalidInputError, match="from 25 to 100 inlet lengths; `inlet` of solve_film"):
        FilmResolution(inlet=24.0)


def test_barus_oil_above_its_pressures_warns(crowned):
    with pytest.warns(cs.MagnitudeWarning, match=r"viscosity_law = 'barus' at 1.*e\+09 Pa .* exp\(7\) times"):
        coarse_film(film_case(LENGTH, 10.0, 5.0, profile=CROWN), start=crowned)


def test_least_film_between_cells_is_positive():
    centres, edges = np.array([0.0, 1.0, 2.0]), np.array([-0.5, 0.5, 1.5, 2.5])
    least, position, _ = _find_minimum(centres, edges, np.array([0.5, 0.01, 1.0]), np.ones(3, bool))
    assert 0 < least < 0.01
    assert 0.5 < position < 1.0


@pytest.mark.parametrize(
    ("direction", "errors", "ratio"),
    [
        ("cells", [4.0, 2.0, 1.0], 1.5),  # second order
        ("cells", [1.2, 3.0, 1.0], 1.9),  # equal on two levels by chance
        ("columns", [16.0, 4.0, 1.0], 1.0),  # second order
        ("columns", [9.0, 3.0, 1.0], 1.0),
        ("columns", [4.0, 2.0, 1.0], 1.0),  # first order
    ],
)
def test_stated_error_over_the_error_of_the_last_of_three_levels(direction, errors, ratio):
    changes = [np.full(5, change) for change in np.diff(errors)]
    assert _estimate_errors(direction, changes) == pytest.approx(np.full(5, ratio))
    assert np.isinf(_estimate_errors(direction, changes[:1])).all()
