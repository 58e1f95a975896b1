// Where the partners of a pair stand: the box, nearest images, normals, overlaps, levers.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rdpm::contacts {

struct Box {
    double size[3];
    double period[3], inverse_period[3];  // zero in a direction that is not periodic
    const double* wall_velocity;          // (6, 3)
};

template <class Visit>
void for_each_wall(const Box& box, Visit&& visit) {
    for (int face = 5; face >= 0; --face)
        if (box.period[face / 2] == 0) visit(face);
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
    g.lever_i = distance * ai / (ai + aj);
    g.lever_j = distance * aj / (ai + aj);
    return g;
}

// Distance of a centre from face 0..5 (x lower, x upper, y lower, ...), which is known as partner -1 - face.
inline double wall_distance(const Box& box, const double* x, int face) {
    const int d = face / 2;
    return face % 2 ? box.size[d] - x[d] : x[d];
}

inline Geometry wall_geometry(const Box& box, const double* x, double a, int face) {
    Geometry g{};
    g.n[face / 2] = face % 2 ? 1 : -1;
    g.lever_i = wall_distance(box, x, face);
    g.overlap = a - g.lever_i;
    return g;
}

}  // namespace rdpm::contacts
