"""Films of cases: certificate, limits, ends, invalid input."""

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


def make_oil(case, load, lubricant, speed=1.0):
    """Return Barus' oil of constant density for Moes' numbers of a case."""
    modulus = 2 * case.modulus
    speed_root = case.normal_load / (case.contact_length * modulus * RADIUS * load)
    return cs.Lubricant(
        viscosity=0.5 * speed_root**2 * modulus * RADIUS / speed,
        pressure_viscosity=lubricant / (modulus * speed_root**0.5),
        viscosity_law="barus",
        density_law="constant",
    )


def make_film_case(length, load=20.0, lubricant=10.0, *, body=None, profile=None, speed=1.0, end_distance=None):
    roller = cs.Roller(radius=RADIUS, length=length, profile=profile or cs.profiles.Cylinder())
    body = cs.FiniteLengthSpace(length=length, material=STEEL) if body is None else body
    case = cs.Case(body=body, roller=roller, max_pressure=PRESSURE, end_distance=end_distance)
    motion = cs.Sliding(body_speed=speed, roller_speed=speed)
    return replace(case, lubricant=make_oil(case, load, lubricant, abs(speed)), motion=motion)


COARSE_RESOLUTION = replace(
    RESOLUTION, finest=1.1, finest_share=0.24, inner=0.32, inner_inlet=5, growth=0.2, columns=0.24, columns_inlet=0.8
)
LENGTH = 6 * HALF_WIDTH
CROWN = cs.profiles.Lundberg(amplitude=HALF_WIDTH**2 / (4 * RADIUS))


def solve_coarse_film(case, **arguments):
    return solve_film(case, accuracy=0.2, resolution=COARSE_RESOLUTION, **arguments)


@pytest.fixture(scope="module")
def crowned_film():
    return solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN))


def test_certificate_is_small(crowned_film):
    assert bool(crowned_film.converged)
    assert float(crowned_film.mass_error) < 1e-6
    assert float(crowned_film.film_balance_error) < 1e-6
    assert float(crowned_film.film_load_error) < 1e-8
    assert float(crowned_film.film_complementarity_error) < 1e-6


def test_pressure_carries_the_load(crowned_film):
    dy = float(crowned_film.y[1] - crowned_film.y[0])
    load = float((crowned_film.pressure * crowned_film.x_width).sum() * dy)
    assert load == pytest.approx(float(crowned_film.normal_load), rel=1e-9)
    assert float(crowned_film.pressure.min()) >= 0.0


def test_symmetric_roller_has_a_symmetric_film(crowned_film):
    assert float(crowned_film.least_film_first) == pytest.approx(float(crowned_film.least_film_last), rel=1e-3)
    assert float(crowned_film.least_film_first_x + crowned_film.least_film_last_x) == pytest.approx(LENGTH, rel=1e-3)


def test_film_at_half_space_ends_is_thinner(crowned_film):
    body = cs.HalfSpace(material=STEEL)
    half_space_film = solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, body=body, profile=CROWN))
    assert float(half_space_film.least_film) < 0.6 * float(crowned_film.least_film)
    assert float(half_space_film.central_film) == pytest.approx(float(crowned_film.central_film), rel=0.05)


def test_mid_length_film_equals_a_line_contact():
    case = make_film_case(100 * HALF_WIDTH, profile=CROWN, body=cs.HalfSpace(material=STEEL))
    film = solve_coarse_film(case)
    film_scale = RADIUS * np.sqrt(2 * case.lubricant.viscosity / (2 * case.modulus * RADIUS))
    line_film = solve_line(float(film.moes_load), float(film.moes_lubricant), finest=0.1)
    error = float(film.central_film_error) + 5e-3 * float(film.central_film)
    assert abs(float(film.central_film) - line_film.central_film * film_scale) < error
    mid_film = float(film.slice_film.sel(x=50 * HALF_WIDTH, method="nearest"))
    assert mid_film == pytest.approx(line_film.central_film * film_scale, rel=0.04)


@pytest.mark.slow
def test_face_film_of_flush_rollers_has_converged():
    case = make_film_case(4 * HALF_WIDTH, 10.0, 5.0)
    cells = (replace(COARSE_RESOLUTION, columns=0.12 * factor, columns_inlet=0.4 * factor) for factor in (1.0, 0.5))
    film, film_on_narrow_columns = (solve_film(case, accuracy=0.2, resolution=resolution) for resolution in cells)
    assert float(film.least_film_first_x) == pytest.approx(0.0, abs=1e-12)
    assert float(film.least_film_first) < 0.8 * float(film.least_film_middle)
    difference = abs(float(film.least_film_first - film_on_narrow_columns.least_film_first))
    assert difference < float(film.least_film_first_error) < 0.04 * float(film.central_film)


@pytest.mark.slow
def test_tilted_roller_has_minimum_film_at_its_end():
    """On the initial columns the film seven half-widths from the end is thinner than at the end."""
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


def test_reference_lines_are_evaluated_on_finest_cells_only():
    """Coarser levels use the motion of the reference lines of the dry contact."""
    cs.cache.clear()
    film = solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN))
    assert int(film.film_levels) > 2
    assert cs.cache.info().kinds["reference lines"].computed == 2


def test_slice_film_ignores_thin_film_at_ends(crowned_film):
    case = replace(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), lubricant=None, motion=cs.Sliding())
    dry_result = cs.solve(case, accuracy=0.05, stresses=False)
    load = dry_result.pressure.sum("y") * float(dry_result.y[1] - dry_result.y[0])
    speed_root = np.sqrt(2 * make_oil(case, 10.0, 5.0).viscosity / (2 * case.modulus * RADIUS))
    for x in (3 * HALF_WIDTH, HALF_WIDTH):
        load_number = float(load.sel(x=x, method="nearest")) / (2 * case.modulus * RADIUS * speed_root)
        expected = moes_line(load_number, 5.0) * RADIUS * speed_root
        assert float(crowned_film.slice_film.sel(x=x, method="nearest")) == pytest.approx(float(expected), rel=1e-2)
    assert float(crowned_film.slice_film.min()) > 1.5 * float(crowned_film.least_film)
    assert crowned_film.slice_film.attrs["error_kind"] == "not estimated"


def test_reversed_surfaces_mirror_the_film(crowned_film):
    mirrored_film = solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN, speed=-1.0))
    assert float(mirrored_film.least_film_y) == pytest.approx(-float(crowned_film.least_film_y), rel=1e-6)
    assert mirrored_film.film_thickness.values[:, ::-1] == pytest.approx(crowned_film.film_thickness.values, rel=1e-6)
    flow_scale = crowned_film.film_thickness.max()
    for name, sign in (("flow_x", 1), ("flow_y", -1)):
        expected = sign * crowned_film[name].values
        assert mirrored_film[name].values[:, ::-1] == pytest.approx(expected, abs=1e-6 * float(flow_scale), nan_ok=True)
    assert float(mirrored_film.end_flow_last) == pytest.approx(float(crowned_film.end_flow_last), rel=1e-5)


@pytest.mark.parametrize(("speed", "error_ratio"), [pytest.param(1.2, 1.0, marks=pytest.mark.slow), (0.9, 1.1)])
def test_film_at_next_speed_reuses_cells_and_errors(crowned_film, speed, error_ratio):
    """The stated errors cover the film that is refined from the dry contact."""
    case = make_film_case(LENGTH, 10.0, 5.0, profile=CROWN)
    next_case = replace(case, motion=cs.Sliding(body_speed=speed, roller_speed=speed))
    operator_count = cs.cache.info().kinds["surface operators"].computed
    film_from_previous = solve_coarse_film(next_case, start=crowned_film)
    assert cs.cache.info().kinds["surface operators"].computed == operator_count
    film_from_dry_contact = solve_coarse_film(next_case)
    assert int(film_from_previous.film_levels) == 1
    assert int(film_from_previous.newton_steps) < 0.3 * int(film_from_dry_contact.newton_steps)
    assert float(film_from_previous.mass_error) < 1e-6
    for name in ("central_film", "least_film", "least_film_last"):
        cell_errors = [
            float(film[f"{name}_error"] / film[name]) - MIN_RELATIVE_ERROR
            for film in (crowned_film, film_from_previous)
        ]
        assert cell_errors[1] == pytest.approx(error_ratio * cell_errors[0], rel=0.01)
        assert abs(float(film_from_previous[name] - film_from_dry_contact[name])) < float(
            film_from_previous[f"{name}_error"]
        )


def test_film_at_next_speed_is_refined_once_for_accuracy(crowned_film):
    """The stated errors of the refined film cover a film on finer cells."""
    speed = 0.8
    case = replace(
        make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), motion=cs.Sliding(body_speed=speed, roller_speed=speed)
    )
    names = ("central_film", "least_film", "least_film_middle")
    accuracy = max(float(crowned_film[f"{name}_error"] / crowned_film.central_film) for name in names)
    film_from_previous = solve_film(case, accuracy=accuracy, resolution=COARSE_RESOLUTION, start=crowned_film)
    assert int(film_from_previous.film_levels) == 1
    assert film_from_previous.pressure.size > crowned_film.pressure.size
    fine_film = solve_film(case, accuracy=0.2, resolution=RESOLUTION)
    for name in names:
        assert float(film_from_previous[f"{name}_error"]) <= accuracy * float(film_from_previous.central_film)
        assert abs(float(film_from_previous[name] - fine_film[name])) < float(
            film_from_previous[f"{name}_error"] + fine_film[f"{name}_error"]
        )


def test_film_of_another_profile_starts_from_dry_contact(crowned_film):
    deeper_crown = cs.profiles.Lundberg(amplitude=1.2 * CROWN.amplitude)
    other_case = make_film_case(LENGTH, 10.0, 5.0, profile=deeper_crown)
    film_of_other_profile = solve_coarse_film(other_case, start=crowned_film)
    assert int(film_of_other_profile.film_levels) > 1
    assert float(film_of_other_profile.least_film) == pytest.approx(
        float(solve_coarse_film(other_case).least_film), rel=1e-6
    )


@pytest.mark.parametrize(("tilt", "load_position"), [(1e-4, None), (0.0, 2.5 * HALF_WIDTH)])
def test_film_obeys_the_gap_equation_between_the_reference_lines(tilt, load_position):
    """The displacements are those of `displacement_field` on the top and at the depth of the reference line."""
    case = replace(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), tilt=tilt, load_position=load_position)
    film = solve_coarse_film(case)
    centre = case.roller_middle if load_position is None else load_position
    line_x = np.linspace(0.0, LENGTH, 201)
    x = film.x.values[[film.sizes["x"] // 3, film.sizes["x"] // 2]]
    top_displacement, line_displacement = (
        cs.displacement_field(case.body, film.pressure, x=positions, y=[0.0], z=[depth]).u_z.values.ravel()
        for positions, depth in ((x, 0.0), (line_x, case.body.depth))
    )
    line_tilt, _ = np.polyfit(line_x, line_displacement, 1)
    resultant = float(film.x.weighted(film.pressure.sum("y") * film.x_width).mean())
    line_level = np.interp(resultant, line_x, line_displacement)
    drop = CROWN.drop(x - 0.5 * LENGTH, LENGTH)
    approach = float(film.approach) + float(film.tilt) * (x - centre)
    expected = drop + top_displacement - line_level - line_tilt * (x - resultant) - approach
    operator_count = film.film_thickness.sel(x=x).interp(y=0.0).values
    assert operator_count == pytest.approx(expected, abs=0.01 * float(film.central_film))
    assert load_position is not None or float(film.tilt) == tilt


@pytest.mark.parametrize("load_position", [None, 2.5 * HALF_WIDTH])
def test_approach_of_film_is_smaller_than_dry_approach_by_film(load_position):
    """The approach is smaller than that of the dry contact by about the central film."""
    case = replace(make_film_case(LENGTH, 60.0, 5.0, profile=CROWN), load_position=load_position)
    film, dry_result = solve_coarse_film(case), cs.solve(replace(case, lubricant=None), accuracy=0.02, stresses=False)
    separation = float(dry_result.approach - film.approach)
    assert separation == pytest.approx(float(film.central_film), rel=0.1)
    assert separation < 0.03 * float(dry_result.approach)
    assert float(film.tilt) == pytest.approx(float(dry_result.tilt), rel=0.02, abs=1e-8)
    assert float(film.reference_depth) == float(dry_result.reference_depth)


def test_flows_balance_and_leave_through_both_ends(crowned_film):
    """Mass balance of the rectangle between the centres of the end columns, from the inlet to the middle."""
    inlet = crowned_film.sel(y=slice(-2.5 * HALF_WIDTH, 0.0))
    inflow, outflow = (float(inlet.flow_y.isel(y=row).integrate("x")) for row in (0, -1))
    end_flows = [sign * float(inlet.flow_x.isel(x=column).integrate("y")) for sign, column in ((-1, 0), (1, -1))]
    assert inflow - outflow == pytest.approx(sum(end_flows), rel=0.02)
    assert end_flows[0] == pytest.approx(end_flows[1], rel=1e-3)
    assert float(crowned_film.end_flow_first) == pytest.approx(float(crowned_film.end_flow_last), rel=1e-3)
    # In the middle of the contact the entrained film carries the flow.
    mid_contact = crowned_film.sel(x=0.5 * LENGTH, method="nearest").sel(y=0.0, method="nearest")
    assert float(mid_contact.flow_y) == pytest.approx(
        float(crowned_film.entrainment_speed * mid_contact.film_thickness), rel=0.01
    )
    is_cavitated = crowned_film.film_thickness.notnull() & (crowned_film.pressure == 0)
    assert bool(crowned_film.flow_y.isnull().where(is_cavitated, True).all())
    assert crowned_film.flow_y.attrs["units"] == "m2 s-1"
    assert crowned_film.end_flow_last.attrs["units"] == "m3 s-1"


def test_film_on_quarter_space_equals_film_on_long_body():
    """The second end is 30 half-widths away."""
    length = 30 * HALF_WIDTH + LENGTH
    bodies = cs.QuarterSpace(material=STEEL), cs.FiniteLengthSpace(length=length, material=STEEL)
    films = [
        solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN, body=body, end_distance=0.0))
        for body in bodies
    ]
    for name in ("central_film", "least_film_first", "least_film_last"):
        assert float(films[0][name]) == pytest.approx(float(films[1][name]), rel=5e-3)
    assert float(films[0].least_film_last) < 0.9 * float(films[0].least_film_first)


def test_load_position_balances_the_pressure():
    position = 2.5 * HALF_WIDTH
    film = solve_coarse_film(replace(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), load_position=position))
    resultant = float(film.x.weighted(film.pressure.sum("y") * film.x_width).mean())
    assert resultant == pytest.approx(position, abs=1e-6 * LENGTH)
    assert float(film.tilt) < 0.0
    assert float(film.least_film_first) < float(film.least_film_last)


def test_asperity_pressure_follows_law_of_user():
    stiffness = 1e8  # Pa

    def compute_asperity_pressure(distance):
        return stiffness * np.exp(-distance / 1e-7)

    film = solve_coarse_film(
        make_film_case(LENGTH, 10.0, 5.0, profile=CROWN),
        asperities=Asperities(rms=1e-7, pressure=compute_asperity_pressure),
    )
    distance = film.film_thickness.sel(x=0.5 * LENGTH, y=0.0, method="nearest")
    operator_count = float(film.asperity_pressure.sel(x=0.5 * LENGTH, y=0.0, method="nearest"))
    # The mean height of the film exceeds the distance of the mean planes.
    assert float(compute_asperity_pressure(distance)) <= operator_count < 2 * float(compute_asperity_pressure(distance))
    area = film.x_width * float(film.y[1] - film.y[0])
    load_share = float((film.asperity_pressure * area).sum() / film.normal_load)
    assert float(film.asperity_load_share) == pytest.approx(load_share, rel=1e-3)


def test_asperities_carry_part_of_the_load():
    asperities = Asperities(rms=1e-7)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cs.ConvergenceWarning)
        mixed_film = solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), asperities=asperities)
    assert bool(mixed_film.converged)
    assert 0.0 < float(mixed_film.asperity_load_share) < 1.0
    assert float(mixed_film.film_thickness.min()) > 0.0
    assert bool((mixed_film.asperity_pressure <= mixed_film.pressure * (1 + 1e-9)).all())
    # The viscosity ratio is 1 for a roughness equal to the film thickness.
    assert float(mixed_film.viscosity_ratio) == pytest.approx((float(mixed_film.least_film_middle) / 1e-7) ** 1.3)
    assert float(mixed_film.viscosity_ratio_error) > 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lubricant": None}, "lubricant"),
        ({"motion": cs.Sliding()}, "motion"),
        ({"motion": cs.Sliding(body_speed=1.0, roller_speed=-1.0)}, "motion"),
        ({"coupled": True, "friction": 0.1}, "coupled"),
    ],
)
def test_invalid_case_raises(changes, message):
    case = replace(make_film_case(16 * HALF_WIDTH), **changes)
    with pytest.raises(cs.InvalidInputError, match=message):
        solve_film(case)


def test_invalid_argument_raises():
    case = make_film_case(16 * HALF_WIDTH)
    with pytest.raises(cs.InvalidInputError, match="accuracy"):
        solve_film(case, accuracy=1e-5)
    with pytest.raises(cs.InvalidInputError, match="inlet"):
        solve_film(case, inlet=0.5 * HALF_WIDTH)
    with pytest.raises(cs.InvalidInputError, match="rms"):
        Asperities(rms=0.0)


@pytest.mark.slow
def test_pressure_of_thin_rough_film_equals_dry_contact():
    case = make_film_case(LENGTH, 200.0, 5.0, profile=CROWN)
    film = solve_coarse_film(case, asperities=Asperities(rms=5e-8))
    dry_result = cs.solve(replace(case, lubricant=None), accuracy=0.02, stresses=False)
    pressures = [result.pressure.interp(x=0.5 * LENGTH, y=0.0) for result in (film, dry_result)]
    assert float(film.asperity_load_share) > 0.1
    assert abs(float(pressures[0] - pressures[1])) < 0.005 * PRESSURE


@pytest.mark.parametrize(("name", "length"), [("inlet", 1.0), ("inlet", 200.0), ("outlet", 0.1), ("inlet", np.nan)])
def test_short_or_long_window_raises(name: str, length: float) -> None:
    """With an inlet of one inlet length the film would be two thirds of its value."""
    with pytest.raises(InvalidInputError, match=rf"^{name} = "):
        FilmResolution(**{name: length})
    with pytest.raises(InvalidInputError, match="from 25 to 100 inlet lengths; `inlet` of solve_film"):
        FilmResolution(inlet=24.0)


def test_barus_oil_above_its_pressure_limit_warns(crowned_film):
    with pytest.warns(cs.MagnitudeWarning, match=r"viscosity_law = 'barus' at 1.*e\+09 Pa .* exp\(7\) times"):
        solve_coarse_film(make_film_case(LENGTH, 10.0, 5.0, profile=CROWN), start=crowned_film)


def test_least_film_between_cells_is_positive():
    centres, edges = np.array([0.0, 1.0, 2.0]), np.array([-0.5, 0.5, 1.5, 2.5])
    least_film, position, _ = _find_minimum(centres, edges, np.array([0.5, 0.01, 1.0]), np.ones(3, bool))
    assert 0 < least_film < 0.01
    assert 0.5 < position < 1.0


@pytest.mark.parametrize(
    ("direction", "errors", "error_ratio"),
    [
        ("cells", [4.0, 2.0, 1.0], 1.5),  # second order
        ("cells", [1.2, 3.0, 1.0], 1.9),  # coarsest level with a small error by chance
        ("columns", [16.0, 4.0, 1.0], 1.0),  # second order
        ("columns", [9.0, 3.0, 1.0], 1.0),
        ("columns", [4.0, 2.0, 1.0], 1.0),  # first order
    ],
)
def test_stated_error_exceeds_error_of_finest_level(direction, errors, error_ratio):
    changes = [np.full(5, change) for change in np.diff(errors)]
    assert _estimate_errors(direction, changes) == pytest.approx(np.full(5, error_ratio))
    assert np.isinf(_estimate_errors(direction, changes[:1])).all()
