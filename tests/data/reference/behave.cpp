// Makes fire/behave_*.csv with BEHAVE (github.com/firelab/behave, public domain, at d963287), whose inputs are random here.
//
//     git clone https://github.com/firelab/behave && git -C behave checkout d963287
//     g++ -O1 -Ibehave/src/behave behave.cpp -o answers $(ls behave/src/behave/*.cpp |
//         grep -v -e client -e Contain -e behaveRun -e mortality -e species -e canopy)
//     ./answers fire
//
// Flames are in ft, winds 20 ft above ground in mi/h, moistures in percent.

#include <cstdio>
#include <random>
#include <string>

#include "crown.h"
#include "fineDeadFuelMoistureTool.h"
#include "fuelModels.h"
#include "spot.h"

static std::mt19937 dice(1);

static int below(int end) { return static_cast<int>(dice() % static_cast<unsigned>(end)); }

// A number of one digit after the point.
static double between(int low, int high) { return low + below(10 * (high - low)) / 10.0; }

static FILE *table(const std::string &folder, const char *name, const char *header) {
    FILE *file = std::fopen((folder + "/" + name).c_str(), "w");
    std::fprintf(file, "%s\n", header);
    return file;
}

static void spotting(const std::string &folder) {
    const char *sources[] = {"torching_trees", "burning_pile", "surface_fire"};
    const char *places[] = {"midslope_windward", "valley_bottom", "midslope_leeward", "ridge_top"};
    FILE *out = table(folder, "behave_spotting.csv",
        "source,location,ridge_to_valley_distance_mi,ridge_to_valley_elevation_ft,downwind_cover_height_ft,downwind_canopy,"
        "wind_20ft_mi_h,flame_ft,torching_trees,dbh_in,tree_height_ft,species,firebrand_height_ft,flat_distance_mi,"
        "mountain_distance_mi");
    const auto ft = LengthUnits::Feet, mi = LengthUnits::Miles;
    for (int row = 0; row < 120; row++) {
        int source = row % 3, place = below(4), canopy = below(2), trees = 1 + below(20), species = below(14);
        double distance = between(1, 4), elevation = 100 * below(40), cover = between(5, 100), wind = between(2, 40);
        double flame = source == 1 ? between(5, 60) : between(2, 30), dbh = between(5, 20), height = between(20, 150);
        const auto mode = static_cast<SpotDownWindCanopyMode::SpotDownWindCanopyModeEnum>(canopy);
        const auto location = static_cast<SpotFireLocation::SpotFireLocationEnum>(place);
        const auto tree = static_cast<SpotTreeSpecies::SpotTreeSpeciesEnum>(species);
        Spot spot;
        double brand, flat, mountain;
        if (source == 0) {
            spot.updateSpotInputsForTorchingTrees(location, distance, mi, elevation, ft, cover, ft, mode, trees, dbh,
                LengthUnits::Inches, height, ft, tree, wind, SpeedUnits::MilesPerHour);
            spot.calculateSpottingDistanceFromTorchingTrees();
            brand = spot.getMaxFirebrandHeightFromTorchingTrees(ft);
            flat = spot.getMaxFlatTerrainSpottingDistanceFromTorchingTrees(mi);
            mountain = spot.getMaxMountainousTerrainSpottingDistanceFromTorchingTrees(mi);
        } else if (source == 1) {
            spot.updateSpotInputsForBurningPile(location, distance, mi, elevation, ft, cover, ft, mode, flame, ft, wind,
                SpeedUnits::MilesPerHour);
            spot.calculateSpottingDistanceFromBurningPile();
            brand = spot.getMaxFirebrandHeightFromBurningPile(ft);
            flat = spot.getMaxFlatTerrainSpottingDistanceFromBurningPile(mi);
            mountain = spot.getMaxMountainousTerrainSpottingDistanceFromBurningPile(mi);
        } else {
            spot.updateSpotInputsForSurfaceFire(location, distance, mi, elevation, ft, cover, ft, mode, wind,
                SpeedUnits::MilesPerHour, flame, ft);
            spot.calculateSpottingDistanceFromSurfaceFire();
            brand = spot.getMaxFirebrandHeightFromSurfaceFire(ft);
            flat = spot.getMaxFlatTerrainSpottingDistanceFromSurfaceFire(mi);
            mountain = spot.getMaxMountainousTerrainSpottingDistanceFromSurfaceFire(mi);
        }
        std::fprintf(out, "%s,%s,%g,%g,%g,%s,%g,", sources[source], places[place], distance, elevation, cover,
            canopy ? "open" : "closed", wind);
        if (source == 0) std::fprintf(out, ",%d,%g,%g,%d,", trees, dbh, height, species);
        else std::fprintf(out, "%g,,,,,", flame);
        std::fprintf(out, "%.15g,%.15g,%.15g\n", brand, flat, mountain);
    }
    std::fclose(out);
}

static void moisture(const std::string &folder) {
    FILE *out = table(folder, "behave_fdfm.csv",
        "table,dry_bulb,relative_humidity,aspect,elevation,month,shading,slope,time_of_day,moisture_pct");
    for (int row = 0; row < 200; row++) {
        int bulb = below(6), humidity = below(21), aspect = below(4), elevation = below(3), month = below(3);
        int shading = below(2), slope = below(2), hour = below(6);
        FineDeadFuelMoistureTool tool;
        tool.calculateByIndex(aspect, bulb, elevation, month, humidity, shading, slope, hour);
        if (row % 2)
            std::fprintf(out, "reference,%d,%d,,,,,,,%g\n", bulb, humidity, tool.getReferenceMoisture(FractionUnits::Percent));
        else
            std::fprintf(out, "correction,,,%d,%d,%d,%d,%d,%d,%g\n", aspect, elevation, month, shading, slope, hour,
                tool.getCorrectionMoisture(FractionUnits::Percent));
    }
    std::fclose(out);
}

static void crowns(const std::string &folder) {
    const int fuels[] = {1, 2, 4, 6, 8, 9, 10, 101, 104, 122, 124, 141, 145, 149, 161, 165, 181, 185, 188, 201, 203};
    FILE *out = table(folder, "behave_crown.csv",
        "fuel_model,moisture_1h_pct,moisture_10h_pct,moisture_100h_pct,moisture_live_herb_pct,moisture_live_woody_pct,"
        "moisture_foliar_pct,wind_20ft_mi_h,wind_to_deg_from_upslope,slope_deg,canopy_cover_pct,canopy_height_ft,"
        "canopy_base_height_ft,canopy_bulk_density_lb_ft3,waf_input,crown_ros_ft_min,crown_length_to_width,"
        "crown_intensity_btu_ft_s,crown_flame_ft,rothermel_final_ros_ft_min,rothermel_final_intensity_btu_ft_s,"
        "rothermel_final_flame_ft,fire_type");
    const auto percent = FractionUnits::Percent;
    const auto ft = LengthUnits::Feet;
    FuelModels models;
    for (int row = 0; row < 150; row++) {
        int fuel = fuels[below(21)];
        double dead = between(3, 10), herb = between(40, 120), woody = between(60, 130), foliar = between(70, 140);
        double wind = between(2, 40), slope = below(35), cover = between(10, 90), height = between(25, 100);
        double base = between(2, 15), density = 0.002 + 0.001 * below(20);
        Crown crown(models);
        crown.updateCrownInputs(fuel, dead, dead + 1, dead + 2, herb, woody, foliar, percent, wind, SpeedUnits::MilesPerHour,
            WindHeightInputMode::TwentyFoot, 0, WindAndSpreadOrientationMode::RelativeToUpslope, slope, SlopeUnits::Degrees, 0,
            cover, percent, height, base, ft, (height - base) / height, FractionUnits::Fraction, density,
            DensityUnits::PoundsPerCubicFoot);
        crown.setWindAdjustmentFactorCalculationMethod(WindAdjustmentFactorCalculationMethod::UseCrownRatio);
        crown.doCrownRunRothermel();
        std::fprintf(out, "%d,%g,%g,%g,%g,%g,%g,%g,0,%g,%g,%g,%g,%g,computed,", fuel, dead, dead + 1, dead + 2, herb, woody,
            foliar, wind, slope, cover, height, base, density);
        const auto speed = SpeedUnits::FeetPerMinute;
        const auto intensity = FirelineIntensityUnits::BtusPerFootPerSecond;
        std::fprintf(out, "%.15g,%.15g,%.15g,%.15g,", crown.getCrownFireSpreadRate(speed),
            crown.getCrownFireLengthToWidthRatio(), crown.getCrownFirelineIntensity(intensity), crown.getCrownFlameLength(ft));
        std::fprintf(out, "%.15g,%.15g,%.15g,%d\n", crown.getFinalSpreadRate(speed), crown.getFinalFirelineIntesity(intensity),
            crown.getFinalFlameLength(ft), static_cast<int>(crown.getFireType()));
    }
    std::fclose(out);
}

int main(int, char **arguments) {
    spotting(arguments[1]);
    moisture(arguments[1]);
    crowns(arguments[1]);
}
