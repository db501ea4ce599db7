// Common parts of the programs that trace marched scenes: arguments, files of waves, and timing.
//
//   PEER SCENE DIRECTIONS ITERATIONS FRAMES ENDS
//
// reads start directions, traces one frame to warm up and then FRAMES timed frames, writes the waves of the
// last frame, and prints the processor seconds of each timed frame as one line of JSON. DIRECTIONS and ENDS
// have four floats per wave. DIRECTIONS has a direction and 0. ENDS has a position and a status: 0 for a heard
// wave, 1 for a travelling wave, -1 for a lost wave.
#pragma once

#include "../peer.h"
#include "fields.h"

#include <cstring>
#include <ctime>
#include <stdexcept>

constexpr float HEARD = 0, TRAVELLING = 1, LOST = -1;

struct FourFloats {
    float x, y, z, w;
};

template <class Item>
std::vector<Item> readAll(const std::string &path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    std::vector<Item> items(static_cast<size_t>(file.tellg()) / sizeof(Item));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(items.data()), static_cast<std::streamsize>(items.size() * sizeof(Item)));
    return items;
}

template <class Item>
void writeAll(const std::string &path, const std::vector<Item> &items) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(items.data()), static_cast<std::streamsize>(items.size() * sizeof(Item)));
    if (!file) {
        throw std::runtime_error("cannot write " + path);
    }
}

// Eight waves in the layout of a file.
inline Lanes3 loadEight(const FourFloats *waves) {
    float x[8], y[8], z[8];
    for (int lane = 0; lane < 8; lane++) {
        x[lane] = waves[lane].x;
        y[lane] = waves[lane].y;
        z[lane] = waves[lane].z;
    }
    return {_mm256_loadu_ps(x), _mm256_loadu_ps(y), _mm256_loadu_ps(z)};
}

inline void storeEight(FourFloats *waves, const Lanes3 &p, Lanes status) {
    float x[8], y[8], z[8], w[8];
    _mm256_storeu_ps(x, p.x.v);
    _mm256_storeu_ps(y, p.y.v);
    _mm256_storeu_ps(z, p.z.v);
    _mm256_storeu_ps(w, status.v);
    for (int lane = 0; lane < 8; lane++) {
        waves[lane] = {x[lane], y[lane], z[lane], w[lane]};
    }
}

// `trace` takes the first of eight directions, the number of iterations, and the destination of the ends.
template <class Trace>
void timeWaves(char **values, Trace trace) {
    const std::vector<FourFloats> directions = readAll<FourFloats>(values[2]);
    const uint32_t iterations = number(values[3], "iterations", 1), frames = number(values[4], "frames", 1);
    std::vector<FourFloats> ends(directions.size());
    std::printf("{\"seconds\": [");
    for (uint32_t frame = 0; frame <= frames; frame++) {
        const std::clock_t began = std::clock();
        for (size_t first = 0; first + 8 <= directions.size(); first += 8) {
            trace(&directions[first], iterations, &ends[first]);
        }
        if (frame > 0) {
            std::printf("%s%.6f", frame > 1 ? ", " : "", double(std::clock() - began) / CLOCKS_PER_SEC);
        }
    }
    std::printf("]}\n");
    writeAll(values[5], ends);
}

inline void expectArguments(int count, int wanted, char **values, const char *usage) {
    if (count != wanted) {
        throw std::runtime_error(std::string("usage: ") + values[0] + " " + usage);
    }
}

// Calls `body` with the scene of that name.
template <class Body>
void withScene(const std::string &name, Body body) {
    if (name == "cave") {
        body(Cave());
    } else if (name == "gyroid" || name == "gyroid-gradient") {
        body(Gyroid());
    } else if (name == "ground") {
        body(Ground());
    } else {
        throw std::runtime_error("unknown scene " + name);
    }
}
