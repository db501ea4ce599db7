    // @label@
    if (@is_met@) {
        p = hit;
@projection@
        d = mirror(along, normal);
    }
