// Tangential lubrication of one pair: its surfaces slip against each other, or roll through the gap together.
// docs/theory/lubrication.md numbers the equations.
#pragma once
#include <utility>

#include "rdpm/contacts/substep_task.hpp"

namespace rdpm::contacts {

// A body or a wall of the pair; a wall has neither mass nor id.
struct LubricatedPartner {
    std::int64_t id;
    double inverse_mass, inverse_moment, lever;
    const double *v, *w;
    double turn() const { return lever * lever * inverse_moment; }
};

// Impulses against slip and roll in one direction of the tangent plane, per slip and roll before them,
// equation (8): the matrix is symmetric and positive, and stops both at most. `share`: c of equation (4).
struct TangentialImpulses {
    double slip_slip, slip_roll, roll_roll;

    // to_slip, to_roll: times h; `most`: largest rate times h.
    TangentialImpulses(double to_slip, double to_roll, double most, double share,
                       const LubricatedPartner& one, const LubricatedPartner& other) {
        const double mass = one.inverse_mass + other.inverse_mass, turn = one.turn() + other.turn();
        const double ss = mass + turn, rr = share * share * mass + turn,
                     sr = share * mass + one.turn() - other.turn();
        if (to_slip * ss > most) to_slip = most / ss;
        if (to_roll * rr > most) to_roll = most / rr;
        const double both = to_slip * to_roll;
        const double inverse = 1 / (1 + to_slip * ss + to_roll * rr + both * (ss * rr - sr * sr));
        slip_slip = (to_slip + both * rr) * inverse;
        slip_roll = -both * sr * inverse;
        roll_roll = (to_roll + both * ss) * inverse;
    }
};

// What part of the relative velocity is in the roll, equation (4): around the axis of a cylinder or of a
// pair, and along the axis of a cylinder.
struct RollShares {
    double around, along;
    const double* axis;  // null but for cylinders

    RollShares(const Box& box, const Geometry& g, std::int64_t j) : around(-1), along(-1), axis(nullptr) {
        const std::int64_t inner = -1 - j - kFirstInner;
        const bool is_cylinder = j < 0 && inner >= 0 && box.walls[inner].shape == kCylinder;
        const double sum = g.lever_i + g.lever_j;
        if (is_cylinder) axis = box.walls[inner].direction;
        if ((j >= 0 || is_cylinder) && sum != 0) around = (g.lever_i - g.lever_j) / sum;
    }

    void apply(const double* from, double* to) const {
        const double lengthwise = axis ? (along - around) * dot(from, axis) : 0;
        for (int d = 0; d < 3; ++d) to[d] = around * from[d] + (axis ? lengthwise * axis[d] : 0);
    }
};

inline void cross(const double* a, const double* b, double* c) {
    for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        c[d] = a[e] * b[f] - a[f] * b[e];
    }
}

// Impulses against slip and roll, in every direction of the tangent plane.
inline void tangential_impulses(double to_slip, double to_roll, double most, const RollShares& shares,
                                const LubricatedPartner& one, const LubricatedPartner& other,
                                const double* slip, const double* roll, double* against_slip,
                                double* against_roll) {
    const TangentialImpulses around(to_slip, to_roll, most, shares.around, one, other);
    for (int d = 0; d < 3; ++d) {
        against_slip[d] = around.slip_slip * slip[d] + around.slip_roll * roll[d];
        against_roll[d] = around.slip_roll * slip[d] + around.roll_roll * roll[d];
    }
    if (!shares.axis) return;
    const TangentialImpulses along(to_slip, to_roll, most, shares.along, one, other);
    const double s = dot(slip, shares.axis), r = dot(roll, shares.axis);
    const double cross_term = along.slip_roll - around.slip_roll;
    for (int d = 0; d < 3; ++d) {
        against_slip[d] += ((along.slip_slip - around.slip_slip) * s + cross_term * r) * shares.axis[d];
        against_roll[d] += (cross_term * s + (along.roll_roll - around.roll_roll) * r) * shares.axis[d];
    }
}

// Linearly implicit, at the resistance in the middle of h; equations (3) to (8). `Bodies` and `Pair` are
// those of a driver. `turned` gets the angular impulses, a row a body. The upper body comes first, so that
// the last bit does not depend on which of them is i.
template <class Bodies, class Pair>
void lubricate_tangentially(const Bodies& b, const Box& box, const Pair& p, const Geometry& g,
                            const LubricationRow& row, double h, double* turned) {
    const double to_slip = h * row.to_slip(-g.overlap), to_roll = h * row.to_roll(-g.overlap);
    if (to_slip == 0 && to_roll == 0) return;
    LubricatedPartner partners[2] = {{p.i, p.inverse_mass_i, p.inverse_moment_i, g.lever_i,
                                      b.velocity_of(p.i), b.angular_velocity_of(p.i)},
                                     {p.j, p.inverse_mass_j, p.inverse_moment_j, g.lever_j, p.vj, p.wj}};
    RollShares shares(box, g, p.j);
    double n[3] = {g.n[0], g.n[1], g.n[2]};
    if (p.j >= 0 && points_up(n)) {
        std::swap(partners[0], partners[1]);
        shares.around = -shares.around;
        for (double& c : n) c = -c;
    }
    const LubricatedPartner &one = partners[0], &other = partners[1];

    double turn_one[3], turn_other[3], u[3], slip[3], roll[3];
    cross(one.w, n, turn_one);
    cross(other.w, n, turn_other);
    for (int d = 0; d < 3; ++d) u[d] = one.v[d] - other.v[d];
    const double along = dot(u, n);
    for (int d = 0; d < 3; ++d) u[d] -= along * n[d];
    shares.apply(u, roll);
    for (int d = 0; d < 3; ++d) {
        slip[d] = u[d] + one.lever * turn_one[d] + other.lever * turn_other[d];
        roll[d] += one.lever * turn_one[d] - other.lever * turn_other[d];
    }
    double against_slip[3], against_roll[3], push[3], both[3], difference[3], twist[2][3];
    tangential_impulses(to_slip, to_roll, h * row.largest_rate, shares, one, other, slip, roll, against_slip,
                        against_roll);
    shares.apply(against_roll, push);
    for (int d = 0; d < 3; ++d) {
        push[d] += against_slip[d];
        both[d] = against_slip[d] + against_roll[d];
        difference[d] = against_slip[d] - against_roll[d];
    }
    cross(n, both, twist[0]);
    cross(n, difference, twist[1]);
    for (int which = 0; which < 2; ++which) {
        const LubricatedPartner& s = partners[which];
        if (s.id < 0) continue;
        double *v = b.velocity_of(s.id), *w = b.angular_velocity_of(s.id), *impulse = b.impulse_of(s.id),
               *angular = b.angular_impulse_of(s.id), *lubricated = turned + 3 * s.id;
        for (int d = 0; d < 3; ++d) {
            const double force = which ? push[d] : -push[d], torque = -s.lever * twist[which][d];
            v[d] += force * s.inverse_mass;
            w[d] += torque * s.inverse_moment;
            impulse[d] += force;
            angular[d] += torque;
            lubricated[d] += torque;
        }
    }
}

}  // namespace rdpm::contacts
