uniform int uMaterialTable;   // index of the first surface's entry in the scene's data

void copyMaterials() {}

// The material of the object that changes a wave's direction by `turned`.
float materialAt(float object, vec3 turned) {
    vec4 entry = sceneData(uMaterialTable + int(max(object, 1.0)) - 1);
@of_groups@
@of_walls@
}

