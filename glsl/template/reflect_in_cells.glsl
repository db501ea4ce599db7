    if (object > 0.0@others@) {
        vec4 entry = entryOf(object);
        p = hit;
        projectOntoKind(entry.y, int(entry.z), along, p, normal);
        metNormal = normal;
        isMirrored = true;
    }
