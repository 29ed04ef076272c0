// A planner for `wildfire`: an RRT of motions that the truck can drive, in C++17 without libraries.
//
// Build it:    g++ -O2 -std=c++17 -o planner FILE
// Try it:      wildfire run contest --command mine=./planner --set unimog.planner=mine
// Compare it:  wildfire plan --planner mine,prm-rs --command mine=./planner --goals 20
//
// The simulation writes a question a line to stdin, this program an answer a line to stdout, both JSON. What you print
// for yourself goes to std::cerr. Metres; radians counter-clockwise from east; a pose is that of the middle of the rear
// axle. `wildfire schema planner-protocol` describes every message.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <limits>
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

struct Pose {
    double x, y, heading;
};

struct Motion {
    double curvature, length;  // 1/m, positive to the left; metres, negative in reverse
};

Pose move(Pose pose, Motion motion) {
    double turned = pose.heading + motion.curvature * motion.length;
    if (motion.curvature == 0) {
        return {pose.x + motion.length * std::cos(pose.heading), pose.y + motion.length * std::sin(pose.heading), turned};
    }
    return {pose.x + (std::sin(turned) - std::sin(pose.heading)) / motion.curvature,
            pose.y - (std::cos(turned) - std::cos(pose.heading)) / motion.curvature, turned};
}

struct Field {
    double cell, width, height, radius, to_centre, length, disc;
    int cols, rows;
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
        length = vehicle["length"].number;
        to_centre = length / 2 - vehicle["rear_overhang"].number;
        // The body as three discs that cover it, with a margin for what lies between two poses that are checked.
        disc = std::hypot(length / 6, vehicle["width"].number / 2) + 0.3;
    }

    bool disc_is_free(double x, double y) const {
        if (x <= disc || x >= width - disc || y <= disc || y >= height - disc) return false;
        for (int col = (x - disc) / cell; col <= (x + disc) / cell && col < cols; col++) {
            for (int row = (y - disc) / cell; row <= (y + disc) / cell && row < rows; row++) {
                if (!bush[static_cast<size_t>(row) * cols + col]) continue;
                // The point of the bush's cell that is nearest to the disc's centre.
                double near_x = std::clamp(x, col * cell, (col + 1) * cell);
                double near_y = std::clamp(y, row * cell, (row + 1) * cell);
                if (std::hypot(x - near_x, y - near_y) < disc) return false;
            }
        }
        return true;
    }

    // Says whether the body keeps clear of bushes and border. It is stricter than it must be, never less strict.
    bool is_free(Pose pose) const {
        for (int third = -1; third <= 1; third++) {
            double along = to_centre + third * length / 3;
            if (!disc_is_free(pose.x + along * std::cos(pose.heading), pose.y + along * std::sin(pose.heading))) return false;
        }
        return true;
    }

    bool motion_is_free(Pose pose, Motion motion) const {
        int steps = std::max(1, static_cast<int>(std::ceil(std::abs(motion.length) / 0.4)));
        for (int step = 1; step <= steps; step++) {
            if (!is_free(move(pose, {motion.curvature, motion.length * step / steps}))) return false;
        }
        return true;
    }
};

struct Goal {
    bool is_pose;
    double x, y, last;  // the heading of a pose, the radius of a disc

    // The point of the truck that counts: its centre for a disc, its rear axle for a pose.
    double distance(const Field& field, Pose pose, double to_x, double to_y) const {
        double ahead = is_pose ? 0 : field.to_centre;
        return std::hypot(pose.x + ahead * std::cos(pose.heading) - to_x, pose.y + ahead * std::sin(pose.heading) - to_y);
    }
    bool is_met(const Field& field, Pose pose) const {
        if (is_pose) {  // this planner ends in poses only by luck; the rules allow 1 mm and 0.001 rad
            double turned = std::remainder(pose.heading - last, 2 * std::acos(-1.0));
            return distance(field, pose, x, y) < 0.001 && std::abs(turned) < 0.001;
        }
        return distance(field, pose, x, y) < last - 0.01;
    }
};

// ---- The search ------------------------------------------------------------------------------------------------------

struct Node {
    Pose pose;
    int before;
    Motion motion;
};

// Grows a tree of poses from the start, by motions towards random points, until one is in the goal.
bool plan(const Field& field, Pose start, const Goal& goal, int budget, uint64_t seed, std::vector<Motion>& path, int& expansions) {
    std::mt19937_64 bits(seed);
    auto uniform = [&](double most) { return most * static_cast<double>(bits() >> 11) / 9007199254740992.0; };
    if (goal.is_met(field, start)) return true;
    std::vector<Node> tree{{start, -1, {0, 0}}};
    for (expansions = 1; expansions <= budget; expansions++) {
        bool is_towards_goal = uniform(1) < 0.2;
        double x = is_towards_goal ? goal.x : uniform(field.width), y = is_towards_goal ? goal.y : uniform(field.height);
        // From the pose of the tree that is nearest to the point, the motion that brings it nearest.
        int nearest = 0;
        for (int index = 1; index < static_cast<int>(tree.size()); index++) {
            if (goal.distance(field, tree[index].pose, x, y) < goal.distance(field, tree[nearest].pose, x, y)) nearest = index;
        }
        double best = std::numeric_limits<double>::infinity();
        Node next{};
        for (double curvature : {0.0, 1 / field.radius, -1 / field.radius}) {
            for (double length : {4.0, -4.0}) {
                Motion motion{curvature, length};
                Pose end = move(tree[nearest].pose, motion);
                double distance = goal.distance(field, end, x, y);
                if (distance < best && field.motion_is_free(tree[nearest].pose, motion)) {
                    best = distance;
                    next = {end, nearest, motion};
                }
            }
        }
        if (std::isinf(best)) continue;
        tree.push_back(next);
        if (goal.is_met(field, next.pose)) {
            for (int index = static_cast<int>(tree.size()) - 1; index > 0; index = tree[index].before) path.push_back(tree[index].motion);
            std::reverse(path.begin(), path.end());
            return true;
        }
    }
    expansions = budget;
    return false;
}

int main() {
    std::string line;
    std::vector<Field> field;  // none, then one
    double seed = 0;
    int budget = 5000;
    while (std::getline(std::cin, line)) {
        Json message = Reader{line}.read();
        const std::string& type = message["type"].text;
        if (type == "hello") {
            std::printf("{\"type\":\"hello\",\"protocol\":1,\"name\":\"rrt\",\"version\":\"1\"}\n");
        } else if (type == "field") {
            field.assign(1, Field(message));
            seed = message["seed"].number;
            if (message["settings"]["iterations"].number > 0) budget = message["settings"]["iterations"].number;
            std::printf("{\"type\":\"ready\"}\n");
        } else if (type == "plan") {
            const Json& from = message["start"];
            const Json& disc = message["goal"]["disc"];
            bool is_pose = disc.list.empty();
            const Json& to = is_pose ? message["goal"]["pose"] : disc;
            // A seed for each query, and a budget that is counted: the same question gets the same answer.
            uint64_t hash = static_cast<uint64_t>(seed) ^ 1469598103934665603u;
            for (char letter : line.substr(line.find("\"start\""))) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211u;
            std::vector<Motion> path;
            int expansions = 0;
            bool is_found = plan(field.at(0), {from[0].number, from[1].number, from[2].number},
                                 {is_pose, to[0].number, to[1].number, to[2].number}, budget, hash, path, expansions);
            std::printf("{\"id\":%.0f,\"expansions\":%d,", message["id"].number, expansions);
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
