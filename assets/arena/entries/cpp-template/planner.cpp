// A planner for `wildfire`: the shortest Reeds-Shepp curve where it is free, otherwise an RRT of such curves, in C++17
// without libraries.
//
// Build it:    g++ -O2 -std=c++17 -o planner FILE
// Try it:      wildfire run contest --command mine=./planner --set unimog.planner=mine
// Compare it:  wildfire plan --planner mine,prm-rs --command mine=./planner --goals 20
//
// As a WebAssembly module, with the same answers and the same count of instructions on every computer:
//   pip install ziglang
//   python3 -m ziglang c++ -std=c++17 -fno-exceptions --target=wasm32-wasi -O2 FILE -o mine.wasm
//   wildfire run contest --module mine=mine.wasm --set unimog.planner=mine
//
// The simulation writes one query per line to stdin, this program writes one answer per line to stdout, both JSON. Print
// your own messages to std::cerr. Metres; radians counter-clockwise from east; a pose is that of the middle of the rear
// axle. `wildfire schema planner-protocol` describes every message.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

// ---- JSON, as much as the messages need ------------------------------------------------------------------------------

struct Json {
    double number = 0;
    std::string text;
    std::vector<Json> list;
    std::map<std::string, Json> members;
    const Json& operator[](const std::string& name) const {
        static const Json nothing;
        auto found = members.find(name);
        return found == members.end() ? nothing : found->second;
    }
    const Json& operator[](size_t index) const { return list.at(index); }
};

struct Reader {
    const std::string& line;
    size_t at = 0;

    void skip_blanks() {
        while (at < line.size() && std::isspace(static_cast<unsigned char>(line[at]))) at++;
    }
    bool take(char wanted) {
        skip_blanks();
        if (at >= line.size() || line[at] != wanted) return false;
        at++;
        return true;
    }
    std::string read_text() {
        std::string text;
        for (at++; at < line.size() && line[at] != '"'; at++) {
            if (line[at] == '\\') at++;  // escapes are rare in what planners are told; they stay as they are
            text += line[at];
        }
        at++;
        return text;
    }
    Json read() {
        Json value;
        skip_blanks();
        if (take('{')) {
            while (!take('}') && at < line.size()) {
                skip_blanks();
                std::string name = read_text();
                take(':');
                value.members[name] = read();
                take(',');
            }
        } else if (take('[')) {
            while (!take(']') && at < line.size()) {
                value.list.push_back(read());
                take(',');
            }
        } else if (at < line.size() && line[at] == '"') {
            value.text = read_text();
        } else if (at < line.size() && std::isalpha(static_cast<unsigned char>(line[at]))) {
            while (at < line.size() && std::isalpha(static_cast<unsigned char>(line[at]))) value.text += line[at++];
        } else {
            char* end = nullptr;
            value.number = std::strtod(line.c_str() + at, &end);
            at = std::max<size_t>(end - line.c_str(), at + 1);
        }
        return value;
    }
};

// ---- The field and the truck -----------------------------------------------------------------------------------------

const double QUARTER = std::acos(0.0), HALF_TURN = 2 * QUARTER, TURN = 4 * QUARTER;
const int CURVES = 1000;      // tried for a query unless the setting `curves` says otherwise: counted effort repeats
const double STEP = 15;       // m, the most that the tree grows by at once
const double MARGIN = 0.1;    // m kept from bushes and border; the rules ask for 0.01 m
const double FAR = 2;         // m; gaps are measured up to here, so that only a few bushes near the truck are looked at
const double ENDLESS = 1e300;

struct Pose {
    double x, y, heading;
    Pose ahead(double metres) const { return {x + metres * std::cos(heading), y + metres * std::sin(heading), heading}; }
    double distance(Pose other) const { return std::hypot(other.x - x, other.y - y); }
};

struct Motion {
    double curvature, length;  // 1/m, positive to the left; metres, negative in reverse
};

using Segments = std::vector<Motion>;

double length_of(const Segments& segments) {
    double sum = 0;
    for (Motion motion : segments) sum += std::abs(motion.length);
    return sum;
}

// The pose after a motion: an arc, or a straight if the curvature is 0.
Pose move(Pose pose, Motion motion) {
    if (motion.curvature == 0) return pose.ahead(motion.length);
    double turned = pose.heading + motion.curvature * motion.length;
    return {pose.x + (std::sin(turned) - std::sin(pose.heading)) / motion.curvature,
            pose.y - (std::cos(turned) - std::cos(pose.heading)) / motion.curvature, turned};
}

struct Goal {
    bool is_pose;
    double x, y, last;  // the heading of a pose, the radius of a disc
};

struct Field {
    double cell, width, height, radius, to_centre, half_length, half_width, stretch;
    int cols, rows, ring;
    std::vector<bool> bush;

    explicit Field(const Json& message) {
        cell = message["cell_m"].number;
        cols = static_cast<int>(message["cols"].number);
        rows = static_cast<int>(message["rows"].number);
        width = cols * cell;
        height = rows * cell;
        bush.resize(static_cast<size_t>(cols) * rows);
        for (const Json& at : message["cells_cr"].list) bush[at[1].number * cols + at[0].number] = true;
        const Json& vehicle = message["vehicle"];
        radius = vehicle["min_turn_radius"].number;
        half_length = vehicle["length"].number / 2;
        half_width = vehicle["width"].number / 2;
        to_centre = half_length - vehicle["rear_overhang"].number;
        // While the rear axle drives 1 m, no point of the body moves by more than the outer corner does in a turn.
        stretch = std::hypot(1 + half_width / radius, (std::abs(to_centre) + half_length) / radius);
        // Bushes within FAR of the body are at most so many cells from the one in which its centre is.
        ring = static_cast<int>(std::ceil((std::hypot(half_length, half_width) + FAR) / cell));
    }

    // A lower bound on the distance from the body to bushes and border, FAR at most; negative if they meet. Two rectangles
    // are apart if they are so along a side of one of them (the separating axis theorem), and at least as far as that.
    double gap(Pose pose) const {
        Pose centre = pose.ahead(to_centre);
        double cos = std::cos(pose.heading), sin = std::sin(pose.heading), half = cell / 2;
        // Half the body's extent along the axes of the field, and half a bush's along those of the body.
        double east = half_length * std::abs(cos) + half_width * std::abs(sin);
        double north = half_length * std::abs(sin) + half_width * std::abs(cos);
        double turned = half * (std::abs(cos) + std::abs(sin));
        double least = std::min({centre.x - east, width - centre.x - east, centre.y - north, height - centre.y - north, FAR});
        if (least < 0) return least;  // outside there are no cells
        int middle_col = static_cast<int>(centre.x / cell), middle_row = static_cast<int>(centre.y / cell);
        for (int row = std::max(0, middle_row - ring); row <= std::min(rows - 1, middle_row + ring); row++) {
            for (int col = std::max(0, middle_col - ring); col <= std::min(cols - 1, middle_col + ring); col++) {
                if (!bush[static_cast<size_t>(row) * cols + col]) continue;
                double dx = (col + 0.5) * cell - centre.x, dy = (row + 0.5) * cell - centre.y;
                double apart = std::max({std::abs(dx) - east - half, std::abs(dy) - north - half,
                                         std::abs(dx * cos + dy * sin) - half_length - turned,
                                         std::abs(dy * cos - dx * sin) - half_width - turned});
                least = std::min(least, apart);
            }
        }
        return least;
    }

    // Returns whether the truck's centre is in the goal, if that is a disc; curves to a pose end there anyway.
    bool is_in_disc(Pose pose, const Goal& goal) const {
        return !goal.is_pose && pose.ahead(to_centre).distance({goal.x, goal.y, 0}) < goal.last - 0.01;
    }
};

// What was driven of some segments, the pose there, and whether the goal or the end of the segments was reached.
struct Drive {
    Segments driven;
    Pose pose;
    bool is_done = true;
};

// Drives along segments until the body is not free, the goal is reached or `most` metres are driven.
Drive drive(const Field& field, Pose pose, const Segments& segments, const Goal& goal, double most = ENDLESS) {
    Drive drive{{}, pose};
    double gap = field.gap(pose);
    for (Motion motion : segments) {
        double done = 0, whole = std::abs(motion.length);
        Pose begin = drive.pose;
        bool is_there = false;
        while (done < whole) {
            is_there = field.is_in_disc(drive.pose, goal);
            if (is_there) break;
            // Nothing can be hit before the gap is used up, so that there is nothing to check on the way there.
            double to = std::min(done + std::max(gap, MARGIN) / field.stretch, whole);
            Pose after = move(begin, {motion.curvature, std::copysign(to, motion.length)});
            gap = field.gap(after);
            if (gap < MARGIN || to > most) break;
            drive.pose = after;
            done = to;
        }
        if (done > 0) drive.driven.push_back({motion.curvature, std::copysign(done, motion.length)});
        if (done < whole) {
            drive.is_done = is_there;
            return drive;
        }
        most -= done;
    }
    return drive;
}

// ---- Reeds-Shepp curves (Reeds and Shepp, 1990) ----------------------------------------------------------------------

// Keeps the shortest of many curves. A part is a side (1 a left arc, -1 a right arc, 0 a straight) and a length, which is
// negative in reverse.
struct Shortest {
    double side = 1;  // -1 while curves are those to the mirrored end
    double length = ENDLESS;
    Segments parts;

    void add(std::initializer_list<Motion> curve) {
        // Either way round a circle ends in the same pose; the shorter is taken.
        auto signed_length = [](Motion part) { return part.curvature == 0 ? part.length : std::remainder(part.length, TURN); };
        double sum = 0;
        for (Motion part : curve) sum += std::abs(signed_length(part));
        if (sum >= length) return;
        length = sum;
        parts.clear();
        for (Motion part : curve) parts.push_back({side * part.curvature, signed_length(part)});
    }

    // Adds the curves from (0, 0, 0) to (x, y, turn) that begin with a left arc, for a turning radius of 1.
    //
    // Every formula solves the same equation. The centre of the first circle is (0, 1), that of the last one follows from
    // the goal, and the parts in between lead from one to the other: a straight adds its length times a unit vector, two
    // circles that touch add 2. Not every curve here is the shortest of its kind, but each ends in the goal, and the
    // shortest of all is among them.
    void add_from_left(double x, double y, double turn) {
        // The last circle is to the left of the goal, `d` from the first in the direction `angle`.
        double dx = x - std::sin(turn), dy = y - 1 + std::cos(turn);
        double d = std::hypot(dx, dy), angle = std::atan2(dy, dx);
        for (double sign : {1.0, -1.0}) {  // the direction of the straight
            double quarter = sign * QUARTER, along = sign > 0 ? angle : angle + HALF_TURN;
            add({{1, along}, {0, sign * d}, {1, turn - along}});
            if (d >= 2) {  // a quarter circle to the right before or after the straight
                double straight = sign * std::sqrt(d * d - 4), offset = std::atan2(2, straight), head = angle - offset;
                add({{1, head + quarter}, {-1, quarter}, {0, straight - 2 * sign}, {1, turn - head}});
                head = angle + offset;
                add({{1, head}, {0, straight - 2 * sign}, {-1, quarter}, {1, turn - head + quarter}});
            }
            if (d <= 4) {  // no straight, but a circle that touches both others
                double half = sign * std::asin(d / 4), first = along + half;
                add({{1, first}, {-1, 2 * half}, {1, turn - first + 2 * half}});
            }
        }
        // The last circle is to the right of the goal.
        dx = x + std::sin(turn), dy = y - 1 - std::cos(turn);
        d = std::hypot(dx, dy), angle = std::atan2(dy, dx);
        for (double sign : {1.0, -1.0}) {
            double quarter = sign * QUARTER, along = sign > 0 ? angle : angle + HALF_TURN;
            add({{1, along + quarter}, {-1, quarter}, {0, sign * (d - 2)}, {-1, along - turn}});
            add({{1, along}, {0, sign * (d - 2)}, {1, quarter}, {-1, along + quarter - turn}});
            if (d >= 2) {
                double straight = sign * std::sqrt(d * d - 4), offset = std::atan2(2, straight), head = angle + offset;
                add({{1, head}, {0, straight}, {-1, head - turn}});
                head = angle - offset + quarter;  // quarter circles before and after the straight
                add({{1, head}, {-1, quarter}, {0, straight - 4 * sign}, {1, quarter}, {-1, head - turn}});
            }
            if (d <= 2) {  // two circles in between, driven equally far, one forward and one in reverse
                double middle = sign * std::acos((2 + d) / 4), head = angle + QUARTER;
                add({{1, head + middle}, {-1, middle}, {1, -middle}, {-1, head - middle - turn}});
            } else if (d <= 6) {  // two circles in between, driven equally far in one direction
                double middle = sign * std::acos((20 - d * d) / 16);
                double first = angle + QUARTER - std::atan2(2 * std::sin(middle), 4 - 2 * std::cos(middle));
                add({{1, first}, {-1, middle}, {1, middle}, {-1, first - turn}});
            }
        }
    }
};

Segments shortest_curve(Pose start, Pose end, double radius) {
    double dx = (end.x - start.x) / radius, dy = (end.y - start.y) / radius;
    double cos = std::cos(start.heading), sin = std::sin(start.heading);
    double x = dx * cos + dy * sin, y = dy * cos - dx * sin, turn = end.heading - start.heading;
    Shortest shortest;
    shortest.add_from_left(x, y, turn);
    shortest.side = -1;  // curves that begin with a right arc are those to the mirrored end, mirrored
    shortest.add_from_left(x, -y, -turn);
    Segments segments;
    for (Motion part : shortest.parts) {
        if (std::abs(part.length) > 1e-9) segments.push_back({part.curvature / radius, part.length * radius});
    }
    return segments;
}

// ---- The search ------------------------------------------------------------------------------------------------------

struct Search {
    const Field& field;
    Pose start;
    Goal goal;
    int budget;
    std::mt19937_64 bits;
    int curves = 0;  // tried so far

    double uniform(double from, double to) { return from + (to - from) * static_cast<double>(bits() >> 11) / 9007199254740992.0; }

    // Finds the shortest free curve from a pose into the goal: to a disc at eight headings, since any will do there.
    bool drive_to_goal(Pose pose, Segments& best) {
        double least = ENDLESS;
        for (int eighth = 0; eighth < (goal.is_pose ? 1 : 8); eighth++) {
            Pose aim{goal.x, goal.y, goal.is_pose ? goal.last : pose.heading + eighth * QUARTER / 2};
            if (!goal.is_pose) aim = aim.ahead(-field.to_centre);
            Drive tried = drive(field, pose, shortest_curve(pose, aim, field.radius), goal);
            curves++;
            if (tried.is_done && length_of(tried.driven) < least) least = length_of(tried.driven), best = tried.driven;
        }
        return least < ENDLESS;
    }

    struct Node {
        Pose pose;
        size_t before;
        Segments driven;
    };

    // Finds a path from the start into the goal, or gives up after `budget` curves.
    bool plan(Segments& path) {
        if (drive_to_goal(start, path)) return true;
        double spread = 20 + start.distance({goal.x, goal.y, 0}) / 2;
        std::vector<Node> tree{{start, 0, {}}};
        while (curves < budget) {
            // Around start and goal, where the path probably is.
            double x = uniform(std::min(goal.x, start.x) - spread, std::max(goal.x, start.x) + spread);
            double y = uniform(std::min(goal.y, start.y) - spread, std::max(goal.y, start.y) + spread);
            Pose aim{x, y, uniform(0, TURN)};
            size_t nearest = 0;
            for (size_t index = 1; index < tree.size(); index++) {
                if (tree[index].pose.distance(aim) < tree[nearest].pose.distance(aim)) nearest = index;
            }
            Pose from = tree[nearest].pose;
            Drive grown = drive(field, from, shortest_curve(from, aim, field.radius), goal, STEP);
            curves++;
            if (length_of(grown.driven) < 1) continue;
            tree.push_back({grown.pose, nearest, grown.driven});
            if (!drive_to_goal(grown.pose, path)) continue;
            for (size_t index = tree.size() - 1; index > 0; index = tree[index].before) {
                path.insert(path.begin(), tree[index].driven.begin(), tree[index].driven.end());
            }
            return true;
        }
        return false;
    }
};

int main() {
    std::string line;
    std::vector<Field> field;  // none, then one
    double seed = 0;
    int budget = CURVES;
    while (std::getline(std::cin, line)) {
        Json message = Reader{line}.read();
        const std::string& type = message["type"].text;
        if (type == "hello") {
            std::printf("{\"type\":\"hello\",\"protocol\":1,\"name\":\"rs-rrt\",\"version\":\"1\"}\n");
        } else if (type == "field") {
            field.assign(1, Field(message));
            seed = message["seed"].number;
            if (message["settings"]["curves"].number > 0) budget = message["settings"]["curves"].number;
            std::printf("{\"type\":\"ready\"}\n");
        } else if (type == "plan") {
            const Json& from = message["start"];
            const Json& disc = message["goal"]["disc"];
            bool is_pose = disc.list.empty();
            const Json& to = is_pose ? message["goal"]["pose"] : disc;
            // A seed for each query, and a budget that is counted: the same question gets the same answer.
            uint64_t hash = static_cast<uint64_t>(seed) ^ 1469598103934665603u;
            for (char letter : line.substr(line.find("\"start\""))) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211u;
            Search search{field.at(0), {from[0].number, from[1].number, from[2].number},
                          {is_pose, to[0].number, to[1].number, to[2].number}, budget, std::mt19937_64(hash)};
            Segments path;
            bool is_found = search.plan(path);
            std::printf("{\"id\":%.0f,\"expansions\":%d,", message["id"].number, search.curves);
            if (is_found) {
                std::printf("\"type\":\"path\",\"segments\":[");
                for (size_t index = 0; index < path.size(); index++) {
                    std::printf("%s[%.17g,%.17g]", index ? "," : "", path[index].curvature, path[index].length);
                }
                std::printf("]}\n");
            } else {
                std::printf("\"type\":\"none\",\"reason\":\"budget-spent\"}\n");
            }
        } else if (type == "end") {
            break;
        }
        std::fflush(stdout);  // without it the simulation would wait for ever
    }
}
