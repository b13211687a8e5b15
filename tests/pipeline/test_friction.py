"""Water properties and friction against published values."""

import numpy as np
import pytest

from pipeline.errors import BrokenPromiseError
from pipeline.steps import friction


def test_density_agrees_with_the_cipm_table():
    # Tanaka et al. 2001, table of the density of water; printed to 1e-4 kg/m3 there.
    temperature_c = [4.0, 10.0, 15.0, 20.0, 30.0]
    printed = [999.9749, 999.7027, 999.1026, 998.2067, 995.6488]
    assert friction.water_density_kg_m3(temperature_c) == pytest.approx(printed, abs=1e-3)


def test_density_of_sea_water_is_that_of_the_international_equation_of_state():
    # UNESCO Technical Papers in Marine Science 44 (1983), check values at atmospheric pressure;
    # its pure water is up to 0.004 kg/m3 lighter than that of the CIPM formula.
    found = friction.water_density_kg_m3([5.0, 25.0], 35.0)
    assert found == pytest.approx([1027.67547, 1023.34306], abs=0.005)


@pytest.mark.parametrize(
    ("temperature_c", "salinity_g_kg", "dynamic_pa_s"),
    # Dorsey 1940, table 87, as fitted in the R package oce; check value of Millero 1974.
    [(10.0, 30.0, 1.383779e-3), (25.0, 40.0, 9.6541e-4)],
)
def test_viscosity_of_sea_water_agrees_with_older_measurements(
    temperature_c, salinity_g_kg, dynamic_pa_s
):
    kinematic_m2_s = friction.kinematic_viscosity_m2_s(temperature_c, salinity_g_kg)
    density_kg_m3 = friction.water_density_kg_m3(temperature_c, salinity_g_kg)
    assert kinematic_m2_s * density_kg_m3 == pytest.approx(dynamic_pa_s, rel=0.015)


def test_viscosity_at_20_c_is_the_international_standard_value():
    # ISO/TR 3666: 1.0034 mm2/s at 20 C, uncertainty 0.17 %.
    assert friction.kinematic_viscosity_m2_s(20.0) == pytest.approx(1.0034e-6, rel=0.0017)


def test_viscosity_agrees_with_the_handbook():
    # CRC Handbook, viscosity of water: 1.3059, 1.0016 and 0.7972 mPa s; half a unit is 0.006 %.
    temperature_c = [10.0, 20.0, 30.0]
    dynamic_pa_s = friction.kinematic_viscosity_m2_s(temperature_c) * friction.water_density_kg_m3(
        temperature_c
    )
    assert dynamic_pa_s == pytest.approx([1.3059e-3, 1.0016e-3, 0.7972e-3], rel=1e-4)


@pytest.mark.parametrize("temperature_c", [-0.1, 40.1, 283.15, np.nan])
def test_temperatures_of_no_liquid_water_are_refused(temperature_c):
    with pytest.raises(BrokenPromiseError, match="0-40 C"):
        friction.water_density_kg_m3([10.0, temperature_c])


def test_friction_line_at_round_reynolds_numbers():
    # By hand: 0.075 / (6 - 2)^2, 0.075 / (7 - 2)^2, 0.075 / (9 - 2)^2.
    by_hand = [0.0046875, 0.003, 0.075 / 49]
    assert friction.ittc57_friction_coefficient([1e6, 1e7, 1e9]) == pytest.approx(by_hand)


def test_friction_falls_with_warmer_water_as_estimated_for_2018():
    # Estimate for 8 m at 2.5 m/s, printed to 0.1 %: 4.3 % more at 2 C and 2.3 % less at 15 C.
    cold, mild, warm = friction.friction_cw_kg_m(2.5, 8.0, 15.0, [2.0, 10.0, 15.0])
    assert cold / mild - 1 == pytest.approx(0.043, abs=0.0005)
    assert warm / mild - 1 == pytest.approx(-0.023, abs=0.0005)


def test_friction_cw_is_the_force_on_a_plate_over_speed_squared():
    speed, length, surface = 2.0, 8.0, 12.0
    reynolds = friction.reynolds_number(speed, length, friction.kinematic_viscosity_m2_s(10.0))
    coefficient = friction.ittc57_friction_coefficient(reynolds)
    force = 0.5 * friction.water_density_kg_m3(10.0) * surface * speed**2 * coefficient
    cw = friction.friction_cw_kg_m(speed, length, surface, 10.0)
    assert cw * speed**2 == pytest.approx(force)
