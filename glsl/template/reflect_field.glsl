    // @label@
    if (@is_met@) {
        p = hit;
@projection@
        metNormal = normal;
        isMirrored = true;
    }
