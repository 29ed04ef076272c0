// A planner of OMPL as a program that `wildfire` asks for drives: usage: planner NAME BUDGET_S
//
// NAME is a geometric planner of OMPL, with `+simplified` behind it if its path is simplified in what is left of the
// budget. BUDGET_S is CPU time of this process for a query, seconds. docs/own-planner.md has the messages; poses are of the
// middle of the rear axle, metres and radians counter-clockwise from east.
//
// The space is OMPL's ReedsSheppStateSpace, and all parameters of its planners are OMPL's defaults. The body's rectangle is
// checked against the squares of the bushes: first by discs in a distance field, and where these do not decide, by the
// axes that separate rectangle and square.
// A motion is looked at as closely as the clearance along it asks for, see `CurveValidator`.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#define BOOST_BIND_GLOBAL_PLACEHOLDERS  // what Boost's own reader of JSON asks for
#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>
#include <ompl/config.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace ob = ompl::base;
namespace og = ompl::geometric;
using boost::property_tree::ptree;
using Space = ob::ReedsSheppStateSpace;

// The program refuses a path that comes nearer than 1 cm; the rest is for what lies between two looks at a motion.
constexpr double least_clearance_m = 0.03;
// The shortest step along a motion. In half of it no point of the body moves 2 cm.
constexpr double least_step_m = 0.03;
// Bushes are looked for this far around the body where its clearance is computed from their squares.
constexpr double reach_m = 1;
// Where the discs prove this much, the squares are not asked.
constexpr double ample_m = 0.15;
// Nodes of the distance field are this far apart.
constexpr double spacing_m = 0.25;
// Distances beyond this are not told apart.
constexpr double horizon_m = 10;

double cpu_s() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<double> numbers(const ptree& list) {
    std::vector<double> found;
    for (const auto& item : list) found.push_back(item.second.get_value<double>());
    return found;
}

// The truck's body on a field of square bushes.
class Field {
public:
    explicit Field(const ptree& message)
        : cell_m(message.get<double>("cell_m")),
          cols(message.get<int>("cols")),
          rows(message.get<int>("rows")),
          width_m(cols * cell_m),
          height_m(rows * cell_m),
          radius_m(message.get<double>("vehicle.min_turn_radius")),
          half_length_m(message.get<double>("vehicle.length") / 2),
          half_width_m(message.get<double>("vehicle.width") / 2),
          ahead_m(half_length_m - message.get<double>("vehicle.rear_overhang")),
          rate(std::hypot(1 + half_width_m / radius_m, (half_length_m + std::abs(ahead_m)) / radius_m)),
          bushes(static_cast<size_t>(cols) * rows) {
        for (const auto& cell : message.get_child("cells_cr")) {
            std::vector<double> at = numbers(cell.second);
            bushes[static_cast<size_t>(at[1]) * cols + static_cast<size_t>(at[0])] = true;
        }
        const int discs = std::max(1, static_cast<int>(std::ceil(half_length_m / half_width_m)));
        for (int disc = 0; disc < discs; disc++) offsets_m.push_back(half_length_m * ((2 * disc + 1.0) / discs - 1));
        disc_m = std::hypot(half_length_m / discs, half_width_m);
        measure_distances();
    }

    const double cell_m;
    const int cols, rows;
    const double width_m, height_m, radius_m, half_length_m, half_width_m;
    // From the rear axle forward to the body's centre.
    const double ahead_m;
    // The most metres that a point of the body moves for a metre of the rear axle.
    const double rate;

    // A lower bound of the body's clearance from bushes and border; negative where it is less than `least_clearance_m`.
    double clearance(double x, double y, double heading) const {
        const double along_x = std::cos(heading), along_y = std::sin(heading);
        const double centre_x = x + ahead_m * along_x, centre_y = y + ahead_m * along_y;
        const double half_x = half_length_m * std::abs(along_x) + half_width_m * std::abs(along_y);
        const double half_y = half_length_m * std::abs(along_y) + half_width_m * std::abs(along_x);
        const double border = std::min(std::min(centre_x, width_m - centre_x) - half_x,
                                       std::min(centre_y, height_m - centre_y) - half_y);
        if (border < least_clearance_m) return -1;
        double bound = border;
        for (double offset : offsets_m) {
            const double lower = distance_bound(centre_x + offset * along_x, centre_y + offset * along_y);
            // The largest disc about this centre inside of the body touches a bush.
            const double inner = std::min(half_width_m, half_length_m - std::abs(offset));
            if (lower + 2 * slack_m < inner) return -1;
            bound = std::min(bound, lower - disc_m);
        }
        if (bound >= ample_m) return bound;
        const double gap = bush_gap(centre_x, centre_y, along_x, along_y, half_x, half_y);
        return gap >= least_clearance_m ? std::min(gap, border) : -1;
    }

private:
    std::vector<bool> bushes;
    // Of the discs that cover the body: where their centres are, forward of the body's, and their radius.
    std::vector<double> offsets_m;
    double disc_m = 0;
    int nodes_x = 0;
    std::vector<float> distances;
    // No point is farther than this from the nearest node.
    const double slack_m = spacing_m / std::sqrt(2.0);

    // Distances of the nodes to the nearest bush, from the squares of all cells within the horizon.
    void measure_distances() {
        nodes_x = static_cast<int>(std::ceil(width_m / spacing_m)) + 2;
        const int nodes_y = static_cast<int>(std::ceil(height_m / spacing_m)) + 2;
        distances.assign(static_cast<size_t>(nodes_x) * nodes_y, static_cast<float>(horizon_m));
        for (int row = 0; row < rows; row++) {
            for (int col = 0; col < cols; col++) {
                if (!bushes[static_cast<size_t>(row) * cols + col]) continue;
                const double west = col * cell_m, south = row * cell_m;
                const int from_y = std::max(0, static_cast<int>((south - horizon_m) / spacing_m));
                const int to_y = std::min(nodes_y - 1, static_cast<int>((south + cell_m + horizon_m) / spacing_m) + 1);
                const int from_x = std::max(0, static_cast<int>((west - horizon_m) / spacing_m));
                const int to_x = std::min(nodes_x - 1, static_cast<int>((west + cell_m + horizon_m) / spacing_m) + 1);
                for (int j = from_y; j <= to_y; j++) {
                    const double y = j * spacing_m, dy = y - std::clamp(y, south, south + cell_m);
                    for (int i = from_x; i <= to_x; i++) {
                        const double x = i * spacing_m, dx = x - std::clamp(x, west, west + cell_m);
                        float& distance = distances[static_cast<size_t>(j) * nodes_x + i];
                        distance = std::min(distance, static_cast<float>(std::sqrt(dx * dx + dy * dy)));
                    }
                }
            }
        }
    }

    // A lower bound of the distance from a point of the field to the nearest bush, at most 2 `slack_m` below it.
    double distance_bound(double x, double y) const {
        const size_t i = static_cast<size_t>(std::clamp(x, 0.0, width_m) / spacing_m + 0.5);
        const size_t j = static_cast<size_t>(std::clamp(y, 0.0, height_m) / spacing_m + 0.5);
        return distances[j * nodes_x + i] - slack_m;
    }

    // A lower bound of the distance to the nearest bush, at most `reach_m`: the widest gap along an axis of the body or of
    // the square. It is exact, but where corners face each other; there it is less.
    double bush_gap(double centre_x, double centre_y, double along_x, double along_y, double half_x, double half_y) const {
        const double half_cell = cell_m / 2, turned = half_cell * (std::abs(along_x) + std::abs(along_y));
        const int from_row = std::max(0, static_cast<int>((centre_y - half_y - reach_m) / cell_m));
        const int to_row = std::min(rows - 1, static_cast<int>((centre_y + half_y + reach_m) / cell_m));
        const int from_col = std::max(0, static_cast<int>((centre_x - half_x - reach_m) / cell_m));
        const int to_col = std::min(cols - 1, static_cast<int>((centre_x + half_x + reach_m) / cell_m));
        double least = reach_m;
        for (int row = from_row; row <= to_row; row++) {
            for (int col = from_col; col <= to_col; col++) {
                if (!bushes[static_cast<size_t>(row) * cols + col]) continue;
                const double dx = (col + 0.5) * cell_m - centre_x, dy = (row + 0.5) * cell_m - centre_y;
                const double gap = std::max(std::max(std::abs(dx * along_x + dy * along_y) - half_length_m - turned,
                                                     std::abs(dy * along_x - dx * along_y) - half_width_m - turned),
                                            std::max(std::abs(dx) - half_x, std::abs(dy) - half_y) - half_cell);
                least = std::min(least, gap);
            }
        }
        return least;
    }
};

double clearance(const Field& field, const ob::State* state) {
    const auto* pose = state->as<Space::StateType>();
    return field.clearance(pose->getX(), pose->getY(), pose->getYaw());
}

// Looks at the shortest Reeds-Shepp curve between two states. The clearance at a pose says how far along the curve nothing
// can be touched; what is left between two poses is halved, long pieces first, so that most collisions are found early, open
// ground costs few looks, and no bush falls between two of them.
class CurveValidator : public ob::MotionValidator {
public:
    CurveValidator(const ob::SpaceInformationPtr& information, const Field& field)
        : ob::MotionValidator(information), space(*information->getStateSpace()->as<Space>()), field(field) {}

    bool checkMotion(const ob::State* from, const ob::State* to) const override {
        Space::ReedsSheppPath curve = space.reedsShepp(from, to);
        const double length_m = curve.length() * field.radius_m;
        ob::State* between = si_->allocState();
        std::vector<Piece> open{{0, clearance(field, from), length_m, clearance(field, to)}};
        bool is_free = open[0].from_room_m >= 0 && open[0].to_room_m >= 0;
        for (size_t next = 0; is_free && next < open.size(); next++) {
            const Piece piece = open[next];
            const double piece_m = piece.to_m - piece.from_m;
            if (piece_m <= std::max(least_step_m, (piece.from_room_m + piece.to_room_m) / field.rate)) continue;
            const double middle_m = (piece.from_m + piece.to_m) / 2;
            bool is_first = false;
            space.interpolate(from, to, middle_m / length_m, is_first, curve, between);
            const double room_m = clearance(field, between);
            is_free = room_m >= 0;
            open.push_back({piece.from_m, piece.from_room_m, middle_m, room_m});
            open.push_back({middle_m, room_m, piece.to_m, piece.to_room_m});
        }
        si_->freeState(between);
        (is_free ? valid_ : invalid_)++;
        return is_free;
    }

    // None of the planners here goes on from where a motion ends early; so nothing of it is said to be free.
    bool checkMotion(const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last) const override {
        const bool is_free = checkMotion(from, to);
        if (!is_free) {
            last.second = 0;
            if (last.first != nullptr) si_->copyState(last.first, from);
        }
        return is_free;
    }

private:
    // A part of a curve, with the clearance at its ends.
    struct Piece {
        double from_m, from_room_m, to_m, to_room_m;
    };

    const Space& space;
    const Field& field;
};

using Maker = std::function<ob::PlannerPtr(const ob::SpaceInformationPtr&)>;

template <class Planner>
ob::PlannerPtr make(const ob::SpaceInformationPtr& information) {
    return std::make_shared<Planner>(information);
}

const std::map<std::string, Maker> planners{{"RRTConnect", make<og::RRTConnect>},
                                            {"PRMstar", make<og::PRMstar>},
                                            {"RRTstar", make<og::RRTstar>},
                                            {"BITstar", make<og::BITstar>},
                                            {"AITstar", make<og::AITstar>}};

// What a planner that improves its path leaves of the budget for simplification.
constexpr double simplifying_share = 0.1;

// Answers one query: a path as segments of curvature, 1/m, and length, metres, or that none was found.
std::string answer(const Field& field, const Maker& maker, bool simplifies, double budget_s, const ptree& query) {
    const double began_s = cpu_s();
    const auto space = std::make_shared<Space>(field.radius_m);
    ob::RealVectorBounds bounds(2);
    bounds.setLow(0);
    bounds.setHigh(0, field.width_m);
    bounds.setHigh(1, field.height_m);
    space->setBounds(bounds);
    og::SimpleSetup setup(space);
    const ob::SpaceInformationPtr information = setup.getSpaceInformation();
    setup.setStateValidityChecker([&field](const ob::State* state) { return clearance(field, state) >= 0; });
    information->setMotionValidator(std::make_shared<CurveValidator>(information, field));
    const auto state = [&](const std::vector<double>& pose) {
        ob::ScopedState<Space> made(space);
        made->setXY(pose.at(0), pose.at(1));
        made->setYaw(std::remainder(pose.at(2), 2 * std::acos(-1.0)));
        return made;
    };
    setup.setStartAndGoalStates(state(numbers(query.get_child("start"))), state(numbers(query.get_child("goal.pose"))));
    setup.setPlanner(maker(information));
    const auto until = [began_s](double share_s) {
        return ob::PlannerTerminationCondition([began_s, share_s] { return cpu_s() - began_s >= share_s; });
    };
    setup.solve(until(simplifies ? (1 - simplifying_share) * budget_s : budget_s));

    std::ostringstream text;
    text.precision(17);
    const std::string id = query.get<std::string>("id");
    // Two poses may have several shortest curves, and rounding decides which is taken: a tree that grew from the goal, or a
    // path stopped while it was simplified, may now lead along one that was never checked.
    if (!setup.haveExactSolutionPath() || !setup.getSolutionPath().check()) {
        text << R"({"type":"none","id":)" << id << R"(,"reason":"budget-spent"})";
        return text.str();
    }
    og::PathGeometric& path = setup.getSolutionPath();
    if (simplifies) {
        const og::PathGeometric found = path;
        og::PathSimplifier(information, setup.getGoal()).simplify(path, until(budget_s), false);
        if (!path.check()) path = found;
    }
    // Segments and not poses, so that nobody else has to choose among curves of one length.
    text << R"({"type":"path","id":)" << id << R"(,"segments":[)";
    const char* comma = "";
    for (size_t index = 1; index < path.getStateCount(); index++) {
        const Space::ReedsSheppPath curve = space->reedsShepp(path.getState(index - 1), path.getState(index));
        for (int part = 0; part < 5; part++) {
            const double length_m = curve.length_[part] * field.radius_m;
            if (curve.type_[part] == Space::RS_NOP || std::abs(length_m) < 1e-9) continue;
            const double turn = curve.type_[part] == Space::RS_LEFT ? 1 : curve.type_[part] == Space::RS_RIGHT ? -1 : 0;
            text << comma << '[' << turn / field.radius_m << ',' << length_m << ']';
            comma = ",";
        }
    }
    text << "]}";
    return text.str();
}

int main(int count, char** words) {
    const std::string asked = count == 3 ? words[1] : "";
    const std::string name = asked.substr(0, asked.find('+'));
    const double budget_s = count == 3 ? std::atof(words[2]) : 0;
    const bool simplifies = asked == name + "+simplified";
    if (planners.count(name) == 0 || (asked != name && !simplifies) || !(budget_s > 0)) {
        std::cerr << "usage: " << words[0] << " NAME[+simplified] BUDGET_S, where NAME is one of";
        for (const auto& planner : planners) std::cerr << ' ' << planner.first;
        std::cerr << '\n';
        return 2;
    }
    ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
    std::unique_ptr<Field> field;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::istringstream text(line);
        ptree message;
        boost::property_tree::read_json(text, message);
        const std::string type = message.get<std::string>("type");
        if (type == "hello") {
            std::cout << R"({"type":"hello","protocol":1,"name":")" << asked << R"(","version":")" << OMPL_VERSION << "\"}";
        } else if (type == "field") {
            field = std::make_unique<Field>(message);
            // OMPL takes 32 bits, of which 0 would let it choose.
            ompl::RNG::setSeed(message.get<std::uint64_t>("seed") % 4294967295u + 1);
            std::cout << R"({"type":"ready"})";
        } else if (type == "plan") {
            std::cout << answer(*field, planners.at(name), simplifies, budget_s, message);
        } else if (type == "end") {
            return 0;
        }
        std::cout << std::endl;
    }
}
