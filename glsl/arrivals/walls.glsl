// Returns the material of the room's wall that changed a wave's direction by `turned`, in the room's
// own axes. Each of x, y and z holds the materials of the walls with the lower and the upper
// coordinate.
float materialOfWall(vec3 turned, vec2 x, vec2 y, vec2 z) {
    vec3 size = abs(turned);
    float ofX = turned.x > 0.0 ? x.x : x.y;
    float ofY = turned.y > 0.0 ? y.x : y.y;
    float ofZ = turned.z > 0.0 ? z.x : z.y;
    return size.x >= max(size.y, size.z) ? ofX : size.y >= size.z ? ofY : ofZ;
}
