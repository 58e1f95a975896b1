// Where the partners of a pair stand: the box, nearest images, normals, overlaps, levers.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rdpm::contacts {

// a b + c, rounded once where the machine can: the compiler is not left to choose which product it fuses.
inline double multiply_add(double a, double b, double c) {
#ifdef FP_FAST_FMA
    return std::fma(a, b, c);
#else
    return a * b + c;
#endif
}

// A wall within the box, as a row of the box's table; `direction`: the normal of a plane, towards the bodies,
// or the axis of a cylinder, of unit length.
struct InnerWall {
    double shape, side, radius;  // side: -1 for bodies inside a cylinder, 1 outside
    double point[3], direction[3], velocity[3], angular_velocity[3];
};
inline constexpr double kPlane = 0, kCylinder = 1;

struct Box {
    double size[3];
    double period[3], inverse_period[3];  // zero in a direction that is not periodic
    bool is_open[3];                      // fluid passes: there are no walls
    const double* wall_velocity;          // (6, 3)
    const InnerWall* walls;
    int inner_walls;
};

// Walls are numbered: faces 0..5 (x lower, x upper, y lower, ...), then kFirstInner + n. Wall w is partner -1
// - w of a body; partner -7 is none.
inline constexpr int kFaces = 6, kFirstInner = 7;

template <class Visit>
void for_each_wall(const Box& box, Visit&& visit) {
    for (int n = box.inner_walls - 1; n >= 0; --n) visit(kFirstInner + n);
    for (int face = kFaces - 1; face >= 0; --face)
        if (box.period[face / 2] == 0 && !box.is_open[face / 2]) visit(face);
}

// Geometry of a pair: the normal points from i to j, overlap > 0 in contact; the levers reach from the
// centres to the contact point and add up to the distance, so that angular momentum is conserved.
struct Geometry {
    double n[3];
    double overlap, lever_i, lever_j;
};

inline double dot(const double* a, const double* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// What is summed over both bodies begins with the upper one, so that its last bit does not depend on which of
// them is i.
inline bool points_up(const double* n) {
    if (n[2] != 0) return n[2] > 0;
    return n[1] != 0 ? n[1] > 0 : n[0] > 0;
}

inline void nearest_image(const Box& box, const double* xi, const double* xj, double* r) {
    for (int d = 0; d < 3; ++d) {
        r[d] = xj[d] - xi[d];
        r[d] -= box.period[d] * std::nearbyint(r[d] * box.inverse_period[d]);
    }
}

inline Geometry sphere_geometry(const Box& box, const double* xi, const double* xj, double ai, double aj) {
    Geometry g;
    nearest_image(box, xi, xj, g.n);
    const double distance = std::sqrt(dot(g.n, g.n));
    const double inverse = distance > 0 ? 1 / distance : 0;
    for (double& c : g.n) c *= inverse;
    g.overlap = ai + aj - distance;
    const double share = distance / (ai + aj);
    g.lever_i = share * ai;
    g.lever_j = share * aj;
    return g;
}

// Away from an inner wall: unit vector and distance from it. In the middle of a tube there is no such vector.
inline double away_from(const Box& box, const InnerWall& wall, const double* x, double* away) {
    double r[3];
    if (wall.shape == kPlane) {
        for (int d = 0; d < 3; ++d) {
            r[d] = x[d] - wall.point[d];
            away[d] = wall.direction[d];
        }
        return dot(r, away);
    }
    nearest_image(box, wall.point, x, r);
    const double along = dot(r, wall.direction);
    for (int d = 0; d < 3; ++d) r[d] -= along * wall.direction[d];
    const double from_axis = std::sqrt(dot(r, r)), inverse = from_axis > 0 ? wall.side / from_axis : 0;
    for (int d = 0; d < 3; ++d) away[d] = inverse * r[d];
    return wall.side * (from_axis - wall.radius);
}

// Distance of a centre from a wall.
inline double wall_distance(const Box& box, const double* x, int wall) {
    if (wall >= kFirstInner) {
        double away[3];
        return away_from(box, box.walls[wall - kFirstInner], x, away);
    }
    const int d = wall / 2;
    return wall % 2 ? box.size[d] - x[d] : x[d];
}

// The lever of a cylinder reaches from its axis, so that its angular velocity moves its surface.
inline Geometry wall_geometry(const Box& box, const double* x, double a, int wall) {
    Geometry g{};
    if (wall >= kFirstInner) {
        const InnerWall& inner = box.walls[wall - kFirstInner];
        g.lever_i = away_from(box, inner, x, g.n);
        for (double& c : g.n) c = -c;
        if (inner.shape == kCylinder) g.lever_j = inner.side * inner.radius;
    } else {
        g.n[wall / 2] = wall % 2 ? 1 : -1;
        g.lever_i = wall_distance(box, x, wall);
    }
    g.overlap = a - g.lever_i;
    return g;
}

inline const double* wall_velocity(const Box& box, int wall) {
    return wall < kFaces ? box.wall_velocity + 3 * wall : box.walls[wall - kFirstInner].velocity;
}

}  // namespace rdpm::contacts
