// A scene of the comparison, as scenes.py writes it. Coordinates are in metres from a corner of the room.
//
// Each line has a word and the numbers that belong to it:
//   room      x y z            the size; walls at 0 and at the size
//   source    x y z
//   listener  x y z radius
//   box       x0 y0 z0 x1 y1 z1
//   pillar    x z radius       along y, without ends
//   turn      x y z w          the unit quaternion that rotates the lattice of directions
#pragma once

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

struct Vec3 {
    float x, y, z;
};

struct Box {
    Vec3 low, high;
};

struct Pillar {
    float x, z, radius;
};

struct Quaternion {
    float x, y, z, w;
};

struct Scene {
    Vec3 room{};
    Vec3 source{};
    Vec3 listener{};
    float listenerRadius = 0;
    std::vector<Box> boxes;
    std::vector<Pillar> pillars;
    Quaternion turn{0, 0, 0, 1};
};

inline std::istream &operator>>(std::istream &in, Vec3 &v) { return in >> v.x >> v.y >> v.z; }

inline Scene readScene(const std::string &path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    Scene scene;
    std::string word;
    while (file >> word) {
        if (word == "room") {
            file >> scene.room;
        } else if (word == "source") {
            file >> scene.source;
        } else if (word == "listener") {
            file >> scene.listener >> scene.listenerRadius;
        } else if (word == "box") {
            Box box{};
            file >> box.low >> box.high;
            scene.boxes.push_back(box);
        } else if (word == "pillar") {
            Pillar pillar{};
            file >> pillar.x >> pillar.z >> pillar.radius;
            scene.pillars.push_back(pillar);
        } else if (word == "turn") {
            file >> scene.turn.x >> scene.turn.y >> scene.turn.z >> scene.turn.w;
        } else {
            throw std::runtime_error(path + ": unknown word " + word);
        }
        if (!file) {
            throw std::runtime_error(path + ": a number is missing after " + word);
        }
    }
    return scene;
}
