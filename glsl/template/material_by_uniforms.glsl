@declarations@

// Copies for the loops, because a driver may load a uniform again at each use.
void copyMaterials() {
@copies@
}

// The material of the object that changes a wave's direction by `turned`.
float materialAt(float object, vec3 turned) {
    float material = 0.0;
@choice@
    return material;
}

