@declarations@

// Copies for the loops: a uniform may be loaded again at each use.
void copyMaterials() {
@copies@
}

// The material of the object that turns a wave by so much.
float materialAt(float object, vec3 turned) {
    float material = 0.0;
@choice@
    return material;
}

