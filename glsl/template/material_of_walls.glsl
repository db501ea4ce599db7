    int walls = int(entry.y);
    vec4 four = sceneData(walls);
    vec4 two = sceneData(walls + 1);
    vec3 own = turned;
@own_axes@
    float ofWall = materialOfWall(own, four.xy, four.zw, two.xy);
    return entry.y > 0.0 ? ofWall : entry.x;
