// Start directions, eight waves at a time: the lattice of glsl/direction/fibonacci.glsl.
#pragma once

#include "lanes.h"
#include "scene.h"

// Sine and cosine of 2 pi times a share of a turn from 0 to 1. The share is folded into the interval within
// an eighth of a turn of a quarter turn, where Taylor series are accurate to 1e-7.
inline void sineAndCosine(Lanes share, Lanes &sine, Lanes &cosine) {
    const Lanes quarter = _mm256_round_ps((share * 4.0f).v, _MM_FROUND_TO_NEAREST_INT);
    const Lanes angle = fma(quarter, -0.25f, share) * 6.28318530718f;
    const Lanes a2 = angle * angle;
    Lanes s = fma(a2, -1.9841270e-4f, 8.3333333e-3f);
    s = fma(s, a2, -1.6666667e-1f);
    s = fma(s * a2, angle, angle);
    Lanes c = fma(a2, 2.4801587e-5f, -1.3888889e-3f);
    c = fma(c, a2, 4.1666667e-2f);
    c = fma(c, a2, -0.5f);
    c = fma(c, a2, 1.0f);
    const __m256i turns = _mm256_cvtps_epi32(quarter.v);
    const Lanes swapped = _mm256_castsi256_ps(_mm256_slli_epi32(turns, 31));
    const __m256i upper = _mm256_and_si256(turns, _mm256_set1_epi32(2));
    const Lanes sineSign = _mm256_castsi256_ps(_mm256_slli_epi32(upper, 30));
    const __m256i next = _mm256_add_epi32(turns, _mm256_set1_epi32(1));
    const __m256i nextUpper = _mm256_and_si256(next, _mm256_set1_epi32(2));
    const Lanes cosineSign = _mm256_castsi256_ps(_mm256_slli_epi32(nextUpper, 30));
    sine = whereNegative(swapped, c, s) ^ sineSign;
    cosine = whereNegative(swapped, s, c) ^ cosineSign;
}

// Computes the directions of the waves first … first + 7 of a lattice of `waves` directions.
class Lattice {
  public:
    Lattice(const Scene &scene, uint32_t waves) : waves(waves) {
        // The columns of the rotation that the quaternion represents.
        const Quaternion q = scene.turn;
        columns[0] = {1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z),
                      2 * (q.x * q.z - q.w * q.y)};
        columns[1] = {2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z),
                      2 * (q.y * q.z + q.w * q.x)};
        columns[2] = {2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x),
                      1 - 2 * (q.x * q.x + q.y * q.y)};
    }

    Lanes3 directions(uint32_t first) const {
        const __m256i steps = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        const __m256i wave = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), steps);
        const __m256i golden = _mm256_set1_epi32(static_cast<int>(2654435769u));
        const __m256i phase = _mm256_srli_epi32(_mm256_mullo_epi32(wave, golden), 8);
        Lanes sine, cosine;
        sineAndCosine(Lanes(_mm256_cvtepi32_ps(phase)) * (1.0f / 16777216.0f), sine, cosine);
        // Counted from the nearer pole, so that rounding never removes the added half.
        const __m256i last = _mm256_set1_epi32(static_cast<int>(waves - 1));
        const __m256i opposite = _mm256_sub_epi32(last, wave);
        const __m256i rank = _mm256_min_epu32(wave, opposite);
        const Lanes share = (Lanes(_mm256_cvtepi32_ps(rank)) + 0.5f) / static_cast<float>(waves);
        const Lanes ring = squareRoot(share * (1.0f - share)) * 2.0f;
        const Lanes up = 1.0f - share * 2.0f;
        const Lanes isUpper = _mm256_castsi256_ps(_mm256_cmpeq_epi32(rank, wave));
        const Lanes height = select(isUpper, up, -up);
        return turned({ring * cosine, height, ring * sine});
    }

    const uint32_t waves;

  private:
    Lanes3 turned(const Lanes3 &p) const {
        const auto row = [&](float a, float b, float c) { return fma(p.x, a, fma(p.y, b, p.z * c)); };
        return {row(columns[0].x, columns[1].x, columns[2].x), row(columns[0].y, columns[1].y, columns[2].y),
                row(columns[0].z, columns[1].z, columns[2].z)};
    }

    Vec3 columns[3];
};
