// Common parts of the programs: arguments, timing, and the printed line.
//
//   PEER SCENE.txt WAVES ITERATIONS FRAMES
//
// traces one frame to warm up and then FRAMES timed frames, and prints one line of JSON: the milliseconds of
// each frame, the number of heard waves by order (number of earlier reflections), and the balance. A frame
// computes its directions, traces all waves, and sums the arrivals.
#pragma once

#include "scene.h"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

struct Result {
    std::vector<uint64_t> hits; // by order
    double left = 0, right = 0;

    explicit Result(uint32_t iterations) : hits(iterations) {}
};

struct Arguments {
    Scene scene;
    uint32_t waves, iterations, frames;
};

inline uint32_t number(const char *text, const char *what, unsigned long least) {
    char *end = nullptr;
    const unsigned long value = std::strtoul(text, &end, 10);
    if (*end != '\0' || value < least || value > (1ul << 24)) {
        throw std::runtime_error(std::string("bad number of ") + what + ": " + text);
    }
    return static_cast<uint32_t>(value);
}

inline Arguments readArguments(int count, char **values) {
    if (count < 5) {
        throw std::runtime_error(std::string("usage: ") + values[0] + " SCENE.txt WAVES ITERATIONS FRAMES");
    }
    Arguments arguments{readScene(values[1]), number(values[2], "waves", 8),
                        number(values[3], "iterations", 1), number(values[4], "frames", 1)};
    // The last few waves are dropped, so that every packet of 16 is full.
    arguments.waves -= arguments.waves % 16;
    return arguments;
}

inline void print(const Result &result, const std::vector<double> &milliseconds) {
    std::printf("{\"milliseconds\": [");
    for (size_t i = 0; i < milliseconds.size(); i++) {
        std::printf("%s%.4f", i ? ", " : "", milliseconds[i]);
    }
    std::printf("], \"hits\": [");
    for (size_t i = 0; i < result.hits.size(); i++) {
        std::printf("%s%llu", i ? ", " : "", static_cast<unsigned long long>(result.hits[i]));
    }
    std::printf("], \"left\": %.3f, \"right\": %.3f}\n", result.left, result.right);
}

// `trace` takes no arguments and returns a Result.
template <typename Trace>
void timeFrames(uint32_t frames, Trace trace) {
    Result result = trace();
    std::vector<double> milliseconds;
    for (uint32_t frame = 0; frame < frames; frame++) {
        const auto began = std::chrono::steady_clock::now();
        result = trace();
        const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - began;
        milliseconds.push_back(passed.count());
    }
    print(result, milliseconds);
}

// Runs a peer's main and prints its errors.
template <typename Body>
int guarded(Body body) {
    try {
        body();
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
