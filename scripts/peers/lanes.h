// Eight floats in an AVX2 register, and three such registers as eight points.
#pragma once

#include <cstdint>
#include <immintrin.h>

struct Lanes {
    __m256 v;

    Lanes() : v(_mm256_setzero_ps()) {}
    Lanes(__m256 v) : v(v) {}
    Lanes(float all) : v(_mm256_set1_ps(all)) {}
};

inline Lanes operator+(Lanes a, Lanes b) { return a.v + b.v; }
inline Lanes operator-(Lanes a, Lanes b) { return a.v - b.v; }
inline Lanes operator*(Lanes a, Lanes b) { return a.v * b.v; }
inline Lanes operator/(Lanes a, Lanes b) { return a.v / b.v; }
inline Lanes operator&(Lanes a, Lanes b) { return _mm256_and_ps(a.v, b.v); }
inline Lanes operator|(Lanes a, Lanes b) { return _mm256_or_ps(a.v, b.v); }
inline Lanes operator^(Lanes a, Lanes b) { return _mm256_xor_ps(a.v, b.v); }
inline Lanes operator-(Lanes a) { return -a.v; }

// Comparisons: all bits of a lane set where true.
inline Lanes operator<(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ); }
inline Lanes operator<=(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ); }
inline Lanes operator>(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ); }
inline Lanes operator==(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ); }
inline Lanes operator!=(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_NEQ_UQ); }

// a b + c with a single rounding.
inline Lanes fma(Lanes a, Lanes b, Lanes c) { return _mm256_fmadd_ps(a.v, b.v, c.v); }
inline Lanes min(Lanes a, Lanes b) { return _mm256_min_ps(a.v, b.v); }
inline Lanes max(Lanes a, Lanes b) { return _mm256_max_ps(a.v, b.v); }
inline Lanes squareRoot(Lanes a) { return _mm256_sqrt_ps(a.v); }
inline Lanes roundDown(Lanes a) { return _mm256_floor_ps(a.v); }
inline Lanes absolute(Lanes a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
// Bits set in b and not in a.
inline Lanes andNot(Lanes a, Lanes b) { return _mm256_andnot_ps(a.v, b.v); }
inline Lanes signOf(Lanes a) { return a & Lanes(-0.0f); }
inline Lanes allSet() { return _mm256_castsi256_ps(_mm256_set1_epi32(-1)); }

inline Lanes select(Lanes condition, Lanes yes, Lanes no) {
    return _mm256_blendv_ps(no.v, yes.v, condition.v);
}

// Selects by the sign bit of each lane.
inline Lanes whereNegative(Lanes sign, Lanes yes, Lanes no) { return _mm256_blendv_ps(no.v, yes.v, sign.v); }

inline int bits(Lanes mask) { return _mm256_movemask_ps(mask.v); }
inline int count(Lanes mask) { return __builtin_popcount(static_cast<unsigned>(bits(mask))); }

inline float sum(Lanes a) {
    alignas(32) float values[8];
    _mm256_store_ps(values, a.v);
    float total = 0;
    for (float value : values) {
        total += value;
    }
    return total;
}

struct Lanes3 {
    Lanes x, y, z;
};

inline Lanes3 operator+(const Lanes3 &a, const Lanes3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lanes3 operator-(const Lanes3 &a, const Lanes3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lanes3 operator&(const Lanes3 &a, Lanes b) { return {a.x & b, a.y & b, a.z & b}; }
inline Lanes dot(const Lanes3 &a, const Lanes3 &b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

// p + t d
inline Lanes3 along(const Lanes3 &p, const Lanes3 &d, Lanes t) {
    return {fma(t, d.x, p.x), fma(t, d.y, p.y), fma(t, d.z, p.z)};
}

inline Lanes3 select(Lanes condition, const Lanes3 &yes, const Lanes3 &no) {
    return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}
