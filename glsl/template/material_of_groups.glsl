    if (entry.z > 0.0) {
        return sceneData(int(entry.z + min(meshGroup, entry.w))).x;
    }
