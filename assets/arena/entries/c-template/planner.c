// A planner for `wildfire`: the shortest Reeds-Shepp curve where it is free, otherwise an RRT of such curves, in C without
// libraries.
//
// Build it:    cc -O2 -o planner FILE -lm
// Try it:      wildfire run contest --command mine=./planner --set unimog.planner=mine
// Compare it:  wildfire plan --planner mine,prm-rs --command mine=./planner --goals 20
//
// As a WebAssembly module, with the same answers and the same count of instructions on every computer:
//   pip install ziglang
//   python3 -m ziglang cc --target=wasm32-wasi -O2 FILE -o mine.wasm
//   wildfire run contest --module mine=mine.wasm --set unimog.planner=mine
//
// The simulation writes one query per line to stdin, this program writes one answer per line to stdout, both JSON. Print
// your own messages to stderr. Metres; radians counter-clockwise from east; a pose is that of the middle of the rear axle.
// `wildfire schema planner-protocol` describes every message.

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double QUARTER = 1.5707963267948966, HALF_TURN = 2 * 1.5707963267948966, TURN = 4 * 1.5707963267948966;
static const double STEP = 15;     // m, the largest growth of the tree per step
static const double MARGIN = 0.1;  // m kept from bushes and border; the rules require 0.01 m
static const double FAR = 2;       // m; gaps are measured up to here, so that only a few bushes near the truck are checked
enum { CURVES = 1000, PARTS = 5 }; // curves per query unless the setting `curves` overrides it; parts of a curve

typedef struct { double x, y, heading; } Pose;
typedef struct { double curvature, length; } Motion;  // 1/m, positive to the left; metres, negative in reverse
typedef struct { Motion parts[PARTS]; int count; double length; } Curve;
typedef struct { bool is_pose; double x, y, last; } Goal;  // `last` is the heading of a pose, the radius of a disc
typedef struct { Pose pose; int before; Curve driven; } Node;

static double cell, width, height, radius, half_length, half_width, to_centre, stretch, seed;
static int cols, rows, ring, budget, curves;
static bool *bush;
static uint64_t bits;

// The length of a vector; `hypot`, which is exact to the last bit, takes several times as long.
static double norm(double x, double y) { return sqrt(x * x + y * y); }

// Reads up to `most` numbers that follow a key, whichever lists they are in; returns how many there are.
static int numbers(const char *line, const char *key, double *to, int most) {
    const char *at = strstr(line, key);
    int count = 0;
    for (at = at ? at + strlen(key) : ""; count < most; count++) {
        char *end;
        at += strspn(at, "[], ");
        to[count] = strtod(at, &end);
        if (end == at) break;
        at = end;
    }
    return count;
}

static double number(const char *line, const char *key) {
    double value = 0;
    numbers(line, key, &value, 1);
    return value;
}

static void read_field(const char *line) {
    cell = number(line, "\"cell_m\":"), cols = (int)number(line, "\"cols\":"), rows = (int)number(line, "\"rows\":");
    width = cols * cell, height = rows * cell, seed = number(line, "\"seed\":");
    radius = number(line, "\"min_turn_radius\":");
    half_length = number(line, "\"length\":") / 2, half_width = number(line, "\"width\":") / 2;
    to_centre = half_length - number(line, "\"rear_overhang\":");
    // While the rear axle drives 1 m, no point of the body moves by more than the outer corner does in a turn.
    stretch = norm(1 + half_width / radius, (fabs(to_centre) + half_length) / radius);
    // Bushes within FAR of the body are at most so many cells from the one in which its centre is.
    ring = (int)ceil((norm(half_length, half_width) + FAR) / cell);
    free(bush);
    bush = calloc((size_t)cols * rows, sizeof *bush);
    double *at = calloc((size_t)cols * rows, 2 * sizeof *at);
    int count = numbers(line, "\"cells_cr\":", at, 2 * cols * rows);
    for (int i = 0; i + 1 < count; i += 2) bush[(int)at[i + 1] * cols + (int)at[i]] = true;
    free(at);
    const char *settings = strstr(line, "\"settings\":");
    budget = settings ? (int)number(settings, "\"curves\":") : 0;
    if (budget <= 0) budget = CURVES;
}

static Pose ahead(Pose pose, double metres) {
    return (Pose){pose.x + metres * cos(pose.heading), pose.y + metres * sin(pose.heading), pose.heading};
}

// The pose after a motion: an arc, or a straight if the curvature is 0.
static Pose move(Pose pose, Motion motion) {
    if (motion.curvature == 0) return ahead(pose, motion.length);
    double turned = pose.heading + motion.curvature * motion.length;
    return (Pose){pose.x + (sin(turned) - sin(pose.heading)) / motion.curvature,
                  pose.y - (cos(turned) - cos(pose.heading)) / motion.curvature, turned};
}

// A lower bound on the distance from the body to bushes and border, FAR at most; negative if they meet. Two rectangles are
// apart if they are so along a side of one of them (the separating axis theorem), and at least as far as that.
static double gap_at(Pose pose) {
    double c = cos(pose.heading), s = sin(pose.heading), half = cell / 2, turned = half * (fabs(c) + fabs(s));
    Pose centre = {pose.x + to_centre * c, pose.y + to_centre * s, pose.heading};
    double east = half_length * fabs(c) + half_width * fabs(s), north = half_length * fabs(s) + half_width * fabs(c);
    double gap = fmin(fmin(centre.x - east, width - centre.x - east), fmin(centre.y - north, height - centre.y - north));
    if (gap < 0) return gap;  // outside there are no cells
    int middle_col = (int)(centre.x / cell), middle_row = (int)(centre.y / cell);
    gap = fmin(gap, FAR);
    for (int row = middle_row - ring; row <= middle_row + ring; row++) {
        for (int col = middle_col - ring; col <= middle_col + ring; col++) {
            if (row < 0 || col < 0 || row >= rows || col >= cols || !bush[row * cols + col]) continue;
            double dx = (col + 0.5) * cell - centre.x, dy = (row + 0.5) * cell - centre.y;
            double field = fmax(fabs(dx) - east - half, fabs(dy) - north - half);
            double body = fmax(fabs(dx * c + dy * s) - half_length, fabs(dy * c - dx * s) - half_width) - turned;
            gap = fmin(gap, fmax(field, body));
        }
    }
    return gap;
}

// Drives along a curve until the body is not free, the goal is reached or `most` metres are driven. Returns whether the
// goal or the end of the curve was reached.
static bool drive(Pose *pose, const Curve *curve, Goal goal, double most, Curve *driven) {
    double gap = gap_at(*pose);
    *driven = (Curve){.count = 0};
    for (int part = 0; part < curve->count; part++) {
        Motion motion = curve->parts[part];
        Pose begin = *pose;
        double done = 0, whole = fabs(motion.length);
        if (whole < 1e-9) continue;
        bool is_there = false;
        while (done < whole) {
            Pose centre = ahead(*pose, to_centre);
            is_there = !goal.is_pose && norm(centre.x - goal.x, centre.y - goal.y) < goal.last - 0.01;
            if (is_there) break;
            // Nothing can be hit before the gap is used up, so there is nothing to check on the way there.
            double to = fmin(done + fmax(gap, MARGIN) / stretch, whole);
            Pose after = move(begin, (Motion){motion.curvature, copysign(to, motion.length)});
            gap = gap_at(after);
            if (gap < MARGIN || driven->length + to > most) break;
            *pose = after, done = to;
        }
        if (done > 0) driven->parts[driven->count++] = (Motion){motion.curvature, copysign(done, motion.length)};
        driven->length += done;
        if (done < whole) return is_there;
    }
    return true;
}

// Keeps a Reeds-Shepp curve if it is shorter than the best. A part is a side (1 a left arc, -1 a right arc, 0 a straight)
// and a length; `side` is -1 while curves are those to the mirrored end.
static void keep_shorter(Curve *best, double side, const Motion *parts, int count) {
    Curve curve = {.count = count};
    for (int i = 0; i < count; i++) {
        // Either way round a circle ends in the same pose; the shorter is taken.
        double length = parts[i].curvature == 0 ? parts[i].length : parts[i].length - TURN * rint(parts[i].length / TURN);
        curve.parts[i] = (Motion){side * parts[i].curvature, length};
        curve.length += fabs(length);
    }
    if (curve.length < best->length) *best = curve;
}
#define ADD(...) keep_shorter(best, side, (Motion[]){__VA_ARGS__}, sizeof((Motion[]){__VA_ARGS__}) / sizeof(Motion))

// Adds the curves from (0, 0, 0) to (x, y, turn) that begin with a left arc, for a turning radius of 1. Every formula solves
// the same equation: the centre of the first circle is (0, 1), that of the last one follows from the goal, and the parts in
// between lead from one to the other: a straight adds its length, two circles that touch add 2 (Reeds and Shepp, 1990).
static void add_from_left(Curve *best, double side, double x, double y, double turn) {
    double to_left = norm(x - sin(turn), y - 1 + cos(turn)), left = atan2(y - 1 + cos(turn), x - sin(turn));
    double to_right = norm(x + sin(turn), y - 1 - cos(turn)), right = atan2(y - 1 - cos(turn), x + sin(turn));
    for (double sign = 1; sign >= -1; sign -= 2) {  // the direction of the straight
        double quarter = sign * QUARTER, d = to_left, along = sign > 0 ? left : left + HALF_TURN;
        ADD({1, along}, {0, sign * d}, {1, turn - along});  // the last circle is to the left of the goal
        if (d >= 2) {
            double straight = sign * sqrt(d * d - 4), offset = atan2(2, straight), head = left - offset;
            ADD({1, head + quarter}, {-1, quarter}, {0, straight - 2 * sign}, {1, turn - head});
            head = left + offset;
            ADD({1, head}, {0, straight - 2 * sign}, {-1, quarter}, {1, turn - head + quarter});
        }
        if (d <= 4) {
            double half = sign * asin(d / 4), first = along + half;
            ADD({1, first}, {-1, 2 * half}, {1, turn - first + 2 * half});
        }
        d = to_right, along = sign > 0 ? right : right + HALF_TURN;  // the last circle is to the right of the goal
        ADD({1, along + quarter}, {-1, quarter}, {0, sign * (d - 2)}, {-1, along - turn});
        ADD({1, along}, {0, sign * (d - 2)}, {1, quarter}, {-1, along + quarter - turn});
        if (d >= 2) {
            double straight = sign * sqrt(d * d - 4), offset = atan2(2, straight), head = right + offset;
            ADD({1, head}, {0, straight}, {-1, head - turn});
            head = right - offset + quarter;
            ADD({1, head}, {-1, quarter}, {0, straight - 4 * sign}, {1, quarter}, {-1, head - turn});
        }
        if (d <= 2) {
            double middle = sign * acos((2 + d) / 4), head = right + QUARTER;
            ADD({1, head + middle}, {-1, middle}, {1, -middle}, {-1, head - middle - turn});
        } else if (d <= 6) {
            double middle = sign * acos((20 - d * d) / 16);
            double first = right + QUARTER - atan2(2 * sin(middle), 4 - 2 * cos(middle));
            ADD({1, first}, {-1, middle}, {1, middle}, {-1, first - turn});
        }
    }
}

static Curve shortest_curve(Pose start, Pose end) {
    double dx = (end.x - start.x) / radius, dy = (end.y - start.y) / radius, c = cos(start.heading), s = sin(start.heading);
    double x = dx * c + dy * s, y = dy * c - dx * s, turn = end.heading - start.heading;
    Curve best = {.length = HUGE_VAL};
    add_from_left(&best, 1, x, y, turn);
    add_from_left(&best, -1, x, -y, -turn);  // curves that begin with a right arc, mirrored
    for (int i = 0; i < best.count; i++) best.parts[i].curvature /= radius, best.parts[i].length *= radius;
    return best;
}

// Finds the shortest free curve from a pose into the goal: to a disc at eight headings, since any will do there.
static bool drive_to_goal(Pose pose, Goal goal, Curve *best) {
    best->length = HUGE_VAL;
    for (int eighth = 0; eighth < (goal.is_pose ? 1 : 8); eighth++, curves++) {
        Pose aim = {goal.x, goal.y, goal.is_pose ? goal.last : pose.heading + eighth * QUARTER / 2}, reached = pose;
        Curve curve = shortest_curve(pose, goal.is_pose ? aim : ahead(aim, -to_centre)), driven;
        if (drive(&reached, &curve, goal, HUGE_VAL, &driven) && driven.length < best->length) *best = driven;
    }
    return best->length < HUGE_VAL;
}

static double uniform(double from, double to) {  // SplitMix64
    uint64_t z = bits += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9, z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return from + (to - from) * (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

// Grows a tree from the start until a free curve leads from it into the goal, or `budget` curves were tried. Returns the
// number of the last node of the path, or -1.
static int search(Node *tree, Pose start, Goal goal, Curve *last) {
    double spread = 20 + norm(goal.x - start.x, goal.y - start.y) / 2;
    tree[0] = (Node){start, -1, {.count = 0}};
    if (drive_to_goal(start, goal, last)) return 0;
    for (int count = 1; curves < budget;) {
        // Around start and goal, where the path probably is.
        double x = uniform(fmin(goal.x, start.x) - spread, fmax(goal.x, start.x) + spread);
        double y = uniform(fmin(goal.y, start.y) - spread, fmax(goal.y, start.y) + spread);
        int nearest = 0;
        double least = HUGE_VAL;
        for (int i = 0; i < count; i++) {
            double dx = tree[i].pose.x - x, dy = tree[i].pose.y - y, squared = dx * dx + dy * dy;
            if (squared < least) least = squared, nearest = i;
        }
        Node grown = {tree[nearest].pose, nearest, {.count = 0}};
        Curve curve = shortest_curve(grown.pose, (Pose){x, y, uniform(0, TURN)});
        drive(&grown.pose, &curve, goal, STEP, &grown.driven);
        curves++;
        if (grown.driven.length < 1) continue;
        tree[count++] = grown;
        if (drive_to_goal(grown.pose, goal, last)) return count - 1;
    }
    return -1;
}

static void print_curve(const Curve *curve, bool *is_first) {
    for (int i = 0; i < curve->count; i++, *is_first = false)
        printf("%s[%.17g,%.17g]", *is_first ? "" : ",", curve->parts[i].curvature, curve->parts[i].length);
}

// Prints what was driven from the root of the tree to a node.
static void print_branch(const Node *tree, int node, bool *is_first) {
    if (node > 0) print_branch(tree, tree[node].before, is_first);
    print_curve(&tree[node].driven, is_first);
}

static void answer(const char *line) {
    double from[3] = {0}, to[3] = {0};
    numbers(line, "\"start\":", from, 3);
    bool is_pose = numbers(line, "\"disc\":", to, 3) == 0;
    if (is_pose) numbers(line, "\"pose\":", to, 3);
    // A seed for each query, and a budget that is counted: the same question gets the same answer.
    bits = (uint64_t)seed ^ 1469598103934665603u;
    for (const char *at = strstr(line, "\"start\""); at && *at; at++) bits = (bits ^ (unsigned char)*at) * 1099511628211u;
    curves = 0;
    Node *tree = malloc(((size_t)budget + 2) * sizeof *tree);
    Curve last;
    int node = search(tree, (Pose){from[0], from[1], from[2]}, (Goal){is_pose, to[0], to[1], to[2]}, &last);
    bool is_first = true;
    printf("{\"id\":%.0f,\"expansions\":%d,", number(line, "\"id\":"), curves);
    if (node >= 0) {
        printf("\"type\":\"path\",\"segments\":[");
        print_branch(tree, node, &is_first);
        print_curve(&last, &is_first);
        printf("]}\n");
    } else {
        printf("\"type\":\"none\",\"reason\":\"budget-spent\"}\n");
    }
    free(tree);
}

int main(void) {
    char *line = NULL;
    size_t room = 0;
    while (getline(&line, &room, stdin) > 0) {
        if (strstr(line, "\"type\":\"hello\"")) puts("{\"type\":\"hello\",\"protocol\":1,\"name\":\"rs-rrt\",\"version\":\"1\"}");
        else if (strstr(line, "\"type\":\"field\"")) read_field(line), puts("{\"type\":\"ready\"}");
        else if (strstr(line, "\"type\":\"plan\"")) answer(line);
        else break;
        fflush(stdout);  // without it the simulation would wait forever
    }
    return 0;
}
