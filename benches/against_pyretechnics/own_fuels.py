#!/usr/bin/env python3
"""Ten custom fuel models beside BEHAVE: rate of spread, intensity and flame length over moistures, winds and slopes.

    python3 benches/against_pyretechnics/own_fuels.py [--wildfire target/release/wildfire]

needs a Python with rasterio and pyrothermel (https://github.com/j-tenny/pyrothermel), which compiles the C++ of BEHAVE
(https://github.com/firelab/behave). This program reads the fuels from `.fmd` files, BEHAVE gets them in its base units. The script
ends with 1 if a relative difference exceeds 1e-6. The fuels are those that the tables of firelab/behave name after

- Weise and Regelbrugge 1997, Recent chaparral fuel modeling efforts, USDA Forest Service: SCAL14 to SCAL18, of southern California.
  Loads in tons per acre, ratios of surface to volume in 1/ft, depth in ft, heat in Btu/lb.
- Fernandes and others 2009, Modelos de combustivel florestal para Portugal: five of grass and shrub. t/ha, 1/cm, cm, kJ/kg.

`fire behavior` takes no custom fuels. Rates are those of `fire spread` on 3 x 3 cells of one fuel, where the times t of the four
neighbours are exact: with A = 1 / (R (1 - e)) and a vector B = e A along the heading, a way v on the slope takes A |v| - B.v, so
A and B follow from sums and differences, and R = 1 / (A - |B|). Intensities and flames are in single precision, and the head's
where a neighbour lies straight ahead, so they are compared there. BEHAVE adds wind and slope as horizontal vectors and rounds the
formula of curing: `--combine flat --curing behave`. It limits wind to 0.9 of the reaction intensity. Wind is at 10 m, no trees.
"""

import argparse
import itertools
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import rasterio
from pyrothermel import behave_core, modes, units

ROOT = Path(__file__).resolve().parents[2]
FUELS = {
    "ENGLISH": """14 SCAL14 3.0 4.5 1.1 1.4 5.0 static 350 1500 250 3 15 9211 9211
15 SCAL15 2.0 3.0 1.0 0.5 2.0 static 640 2200 640 3 13 10000 10000
16 SCAL16 2.2 4.8 1.8 3.0 2.8 static 500 1500 500 6 15 8000 8000
17 SCAL17 1.3 1.0 1.0 2.0 2.0 static 640 2200 640 4 20 8000 8000
18 SCAL18 5.5 0.8 0.1 0.75 2.5 static 640 1500 640 3 25 9200 9200""",
    "METRIC": """20 V-Hb 0.3 0 0 1.2 0 dynamic 60 60 60 35 24 19000 19000
21 V-Ha 0.5 0.1 0 2.5 0.3 dynamic 40 60 40 60 24 19000 19000
22 V-MH 1.0 1.0 0 1.5 5.5 dynamic 45 85 40 55 25 19500 19500
23 V-MMb 4.0 0.5 0 0 7.0 static 30 30 30 90 20 20500 20500
24 V-MAa 9.5 2.5 0 0 14.5 static 35 40 40 105 35 21000 21000""",
}
FOOT_M, POUND_KG, BTU_LB_KJ_KG = 0.3048, 0.45359237, 2.326
FT_MIN_M_S, BTU_FT_S_KW_M = FOOT_M / 60.0, BTU_LB_KJ_KG * POUND_KG / FOOT_M
# Loads to lb/ft2, ratios to 1/ft, depth to ft, heat to Btu/lb.
TO_BASE = {
    "ENGLISH": (2000.0 / 43560.0, 1.0, 1.0, 1.0),
    "METRIC": (0.1 * FOOT_M**2 / POUND_KG, 100.0 * FOOT_M, 0.01 / FOOT_M, 1.0 / BTU_LB_KJ_KG),
}
MOISTURES = [(0.03, 0.04, 0.05, 0.3, 0.6), (0.06, 0.07, 0.08, 0.6, 0.9), (0.09, 0.1, 0.11, 0.95, 1.2), (0.115, 0.12, 0.13, 1.3, 2)]
# Winds in m/s that blow up, across, down and askew of slopes that rise to the north.
WINDS, AZIMUTHS, SLOPES, CELL_M = [0.0, 1.5, 4.0, 9.0], [180.0, 270.0, 0.0, 215.0], [0.0, 0.25, 0.6], 10.0


def behave(system, line, moisture, wind, azimuth, slope):
    """Rate in m/s, intensity in kW/m and flame length in m of the head."""
    load, ratio, depth, heat = TO_BASE[system]
    cells = line.split()
    number = [float(cell) if cell[0].isdigit() else 0.0 for cell in cells]
    models, code = behave_core.FuelModels(), 255
    models.setCustomFuelModel(code, cells[1], cells[1], number[11] * depth, units.LengthUnits.Feet,
        number[12] / 100.0, units.FractionUnits.Fraction,
        number[13] * heat, number[14] * heat, units.HeatOfCombustionUnits.BtusPerPound,
        *(value * load for value in number[2:7]), units.LoadingUnits.PoundsPerSquareFoot,
        *(value * ratio for value in number[8:11]), units.SurfaceAreaToVolumeUnits.SquareFeetOverCubicFeet,
        cells[7] == "dynamic")  # fmt: skip
    surface = behave_core.BehaveRun(models, behave_core.SpeciesMasterTable()).surface
    surface.updateSurfaceInputs(code, *moisture, units.FractionUnits.Fraction,
        wind / FT_MIN_M_S, units.SpeedUnits.FeetPerMinute, modes.WindHeightInputMode.TenMeter, azimuth,
        modes.WindAndSpreadOrientationMode.RelativeToNorth, math.degrees(math.atan(slope)), units.SlopeUnits.Degrees, 180.0,
        0.0, units.FractionUnits.Fraction, 0.0, units.LengthUnits.Feet, 0.0, units.FractionUnits.Fraction)  # fmt: skip
    surface.doSurfaceRunInDirectionOfMaxSpread()
    intensity = surface.getFirelineIntensity(units.FirelineIntensityUnits.BtusPerFootPerSecond) * BTU_FT_S_KW_M
    rate = surface.getSpreadRate(units.SpeedUnits.FeetPerMinute) * FT_MIN_M_S
    return rate, intensity, surface.getFlameLength(units.LengthUnits.Feet) * FOOT_M


def spread(program, folder, system, line, moisture, wind, azimuth, slope):
    """The same of this program; only the rate if no neighbour lies straight ahead."""
    words = ["--fuel", line.split()[0], "--fuel-models", f"{system}.fmd", "--rows", 3, "--cols", 3, "--cell", CELL_M]
    words += ["--moisture", ",".join(map(str, moisture)), "--wind", f"{wind}@{azimuth}", "--slope", slope, "--aspect", 180]
    words += ["--combine", "flat", "--curing", "behave", "--duration", 1e6, "--arrival", "arrival.npy", "--bands", "bands.tif"]
    subprocess.run([program, "fire", "spread", "--quiet", *map(str, words)], stdout=subprocess.DEVNULL, check=True, cwd=folder)
    times = numpy.load(folder / "arrival.npy")
    (_, north, _), (west, _, east), (_, south, _) = times
    a, uphill_m = (east + west) / (2.0 * CELL_M), CELL_M * math.hypot(1.0, slope)
    b = ((west - east) / (2.0 * CELL_M), (south - north) / (2.0 * uphill_m))
    rate = 1.0 / (a - math.hypot(*b))
    if min(map(abs, b)) > 1e-9 * a:
        return (rate,)
    with rasterio.open(folder / "bands.tif") as bands:
        first = numpy.unravel_index(numpy.argmin(numpy.where(times > 0.0, times, numpy.inf)), times.shape)
        return rate, float(bands.read(4)[first]), float(bands.read(3)[first])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wildfire", type=Path, default=ROOT / "target/release/wildfire", help="the program")
    program = parser.parse_args().wildfire.resolve()
    print("largest relative differences\nfuel     fires      rate   heads  intensity  flames")
    worst = [0.0]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for system, lines in FUELS.items():
            (folder / f"{system}.fmd").write_text(f"{system}\n{lines}\n")
            for line in lines.splitlines():
                apart = [[], [], []]
                for moisture, wind, azimuth, slope in itertools.product(MOISTURES, WINDS, AZIMUTHS, SLOPES):
                    theirs = behave(system, line, moisture, wind, azimuth, slope)
                    ours = spread(program, folder, system, line, moisture, wind, azimuth, slope)
                    for differences, one, other in zip(apart, ours, theirs):
                        differences.append(abs(one / other - 1.0))
                largest = [float(numpy.max(differences)) for differences in apart]
                worst += largest
                text = f"{line.split()[1]:8} {len(apart[0]):5} {largest[0]:9.1e} {len(apart[1]):7}"
                print(f"{text} {largest[1]:10.1e} {largest[2]:7.1e}", flush=True)
    print(f"largest of all {numpy.max(worst):.1e}, goal 1e-6")
    sys.exit(0 if numpy.max(worst) <= 1e-6 else 1)


if __name__ == "__main__":
    main()
