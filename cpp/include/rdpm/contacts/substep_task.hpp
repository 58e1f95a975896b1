// What the driver over a contact law works on, and what it tells.
#pragma once
#include <array>

#include "rdpm/contacts/law.hpp"
#include "rdpm/contacts/layout.hpp"
#include "rdpm/contacts/lubrication.hpp"

namespace rdpm::contacts {

// Ended: the force has vanished, the surfaces still overlap.
enum Phase : std::int64_t { kApart = 0, kTouching = 1, kEnded = 2 };

// What the driver remembers of a contact, whatever its law.
struct ContactState {
    std::int64_t phase;
    double start, end, impact_speed, rebound_speed, max_overlap, overlap, work;
};
inline constexpr std::array state_fields{
    RDPM_FIELD(ContactState, phase),         RDPM_FIELD(ContactState, start),
    RDPM_FIELD(ContactState, end),           RDPM_FIELD(ContactState, impact_speed),
    RDPM_FIELD(ContactState, rebound_speed), RDPM_FIELD(ContactState, max_overlap),
    RDPM_FIELD(ContactState, overlap),       RDPM_FIELD(ContactState, work)};

// One finished contact.
struct Finished {
    std::int64_t pair;
    double start, end, max_overlap, impact_speed, rebound_speed, work;
};
inline constexpr std::array finished_fields{
    RDPM_FIELD(Finished, pair),         RDPM_FIELD(Finished, start),
    RDPM_FIELD(Finished, end),          RDPM_FIELD(Finished, max_overlap),
    RDPM_FIELD(Finished, impact_speed), RDPM_FIELD(Finished, rebound_speed),
    RDPM_FIELD(Finished, work)};

// Bodies as a driver sees them: arrays of Python, a row an id.
struct BodyArrays {
    double *x, *v, *w, *rotation;  // (N, 3); rotation vector since the step began
    const double *dv, *dw;         // (N, 3): increments of a sub-step by the non-contact load
    const double *inverse_mass, *inverse_moment, *radius;  // (N,); zero inverses: a prescribed motion
    double *impulse, *angular_impulse, *contact_impulse;   // (N, 3), added to

    double* position_of(std::int64_t i) const { return x + 3 * i; }
    double* velocity_of(std::int64_t i) const { return v + 3 * i; }
    double* angular_velocity_of(std::int64_t i) const { return w + 3 * i; }
    const double* gain_of(std::int64_t i) const { return dv + 3 * i; }
    const double* angular_gain_of(std::int64_t i) const { return dw + 3 * i; }
    double* impulse_of(std::int64_t i) const { return impulse + 3 * i; }
    double* angular_impulse_of(std::int64_t i) const { return angular_impulse + 3 * i; }
    double* contact_impulse_of(std::int64_t i) const { return contact_impulse + 3 * i; }
    double inverse_mass_of(std::int64_t i) const { return inverse_mass[i]; }
    double inverse_moment_of(std::int64_t i) const { return inverse_moment[i]; }
    double radius_of(std::int64_t i) const { return radius[i]; }
};

// The same of one body, in whole lines of the cache: what tells whether a pair touches lies in the first.
struct alignas(64) BodyRow {
    double x[3], v[3], radius, inverse_mass;
    double w[3], inverse_moment, rotation[3], unused;
    double dv[3], dw[3], contact_impulse[3], impulse[3], angular_impulse[3], unused_too;
};
static_assert(sizeof(BodyRow) == 256);

struct BodyBlock {
    BodyRow* rows;

    double* position_of(std::int64_t i) const { return rows[i].x; }
    double* velocity_of(std::int64_t i) const { return rows[i].v; }
    double* angular_velocity_of(std::int64_t i) const { return rows[i].w; }
    const double* gain_of(std::int64_t i) const { return rows[i].dv; }
    const double* angular_gain_of(std::int64_t i) const { return rows[i].dw; }
    double* impulse_of(std::int64_t i) const { return rows[i].impulse; }
    double* angular_impulse_of(std::int64_t i) const { return rows[i].angular_impulse; }
    double* contact_impulse_of(std::int64_t i) const { return rows[i].contact_impulse; }
    double inverse_mass_of(std::int64_t i) const { return rows[i].inverse_mass; }
    double inverse_moment_of(std::int64_t i) const { return rows[i].inverse_moment; }
    double radius_of(std::int64_t i) const { return rows[i].radius; }
};

// Rows of pairs; `parameters` and `history` are those of the law. The driver over a law sees `count` of them:
// pair n in row `rows[n]`, its parameters in row `kinds[rows[n]]`, its bodies `ids` as rows of its own
// arrays.
struct PairArrays {
    const std::int32_t* ids;  // (count, 2)
    const void* parameters;
    const LubricationRow* lubrication;  // null without lubrication
    ContactState* state;
    void* history;
    std::int64_t count;
};

// Pairs [from, to) of a layer; those of one colour share no body.
struct Band {
    std::int32_t from, to;
};

// A band, and the bodies [first, last) that drift together with it: its own, and some that no band of the
// colour has.
struct Group {
    Band band;
    std::int64_t first, last;
};

// Of one colour; bodies [0, wrapped) belong to the last group too: the other side of a periodic seam.
struct Groups {
    const Group* rows;
    std::int64_t count, wrapped;
};

// Of `wake`: a contact that must be looked at in every sub-step.
inline constexpr std::int32_t kUnderWay = -1;

// Fewer pairs than that are all looked at in every sub-step: the smallest gap is then that of every sub-step.
inline constexpr std::int64_t kFewPairs = 64;

struct SubstepTask {
    BodyBlock bodies;  // those that have a pair, and no other
    std::int64_t body_count;
    Box box;
    PairArrays pairs;
    const std::int32_t *rows, *kinds;
    Groups groups[2];        // of even layers, and of odd ones
    std::int32_t* wake;      // (count,): sub-step in which a pair is next looked at, or kUnderWay
    std::int32_t* due;       // (count,): room for the pairs of a band that are looked at
    double acceleration;     // no relative acceleration exceeds this, by the increments, times h
    double inverse_closing;  // no pair closes by more than 1 / inverse_closing in a sub-step
    double* turned;          // (body_count, 3): angular impulses by lubrication; null without
    Finished* finished;
    std::int64_t capacity;  // of `finished`
    double time, h, overlap_limit;
    std::int64_t first, last;
    int threads;
};

struct Progress {
    std::int64_t next, finished, failed;  // failed: the pair past the overlap limit, or -1
    double min_gap;
    double max_overlap;  // [-], of the smaller diameter
};

}  // namespace rdpm::contacts
