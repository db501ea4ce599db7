// A triangle mesh (src/scene/mesh/). Its data begin at index `first` of the scene's data:
//   first:      the corner of the grid with the least coordinates; width of a cell (metres)
//   first + 1:  cells along each axis; -1 if a solid lies around the mesh, otherwise 1
//   first + 2:  indices, relative to first, of the cells, of the lists and of the triangles
//   cells:      four words a vector: -1 - n for the list at vector n; otherwise the skip distance in cells,
//               plus 0.5 in the solid
//   lists:      three indices of triangles (-1: none), and 1 if another vector follows
//   triangles:  four vectors each: the unit normal into the air and the group, plus 0.5 for a face of a sheet
//               without thickness; the corners, each with the length of the edge to the next corner

const float EDGE_ROUNDING = 1.9073486e-6;   // 16 * 2^-23: error bound of a triple product, relative to its lengths
const float HEIGHT_ROUNDING = 9.5367432e-7; // 8 * 2^-23: error bound of a height, relative to the distance
const float MESH_INSET = 2.0;               // distance of a hit from the edges, in error bounds

float meshTriangle = 0.0;   // index in the scene's data of the triangle that the last hit met
float meshGroup = 0.0;      // group of that triangle

float componentOf(vec4 four, int index) {
    vec2 two = index < 2 ? four.xy : four.zw;
    return (index & 1) == 0 ? two.x : two.y;
}

// The word of a cell.
float meshCell(vec3 cell, vec3 count, int cells) {
    int index = int(cell.x) + int(count.x) * (int(cell.y) + int(count.y) * int(cell.z));
    return componentOf(sceneData(cells + (index >> 2)), index & 3);
}

// The triple products of the line from the origin with the edges opposite of the corners a, b and c: positive inside.
// Triangles with a common edge compute the products of one number with opposite signs.
vec3 edgeProducts(vec3 d, vec3 a, vec3 b, vec3 c, vec3 bc, vec3 ca, vec3 ab) {
    return vec3(dot(d, cross(c, bc)), dot(d, cross(a, ca)), dot(d, cross(b, ab)));
}

// Whether air lies directly behind a triangle with this first vector.
bool isSheet(vec4 face) {
    return fract(face.w) > 0.25;
}

// Intersects the line from p along d with the triangle at index `at`, and keeps the nearest hit. The start may lie up
// to errorBound metres behind the face; a line that starts as near to a face of a sheet leaves the other face. A
// product within its error bound counts as inside, so that no line passes between two triangles.
void meetTriangle(int at, vec3 p, vec3 d, float errorBound, inout float nearest, inout float met) {
    vec4 face = sceneData(at);
    vec3 normal = face.xyz;
    vec4 u = sceneData(at + 1);
    vec4 v = sceneData(at + 2);
    vec4 w = sceneData(at + 3);
    vec3 a = u.xyz - p;
    vec3 b = v.xyz - p;
    vec3 c = w.xyz - p;
    float far = 1.7320508 * max(largest(a), max(largest(b), largest(c)));
    vec3 products = edgeProducts(d, a, b, c, v.xyz - w.xyz, w.xyz - u.xyz, u.xyz - v.xyz);
    vec3 least = -(EDGE_ROUNDING * far + errorBound) * vec3(v.w, w.w, u.w);
    float speed = -dot(normal, d);
    float height = -dot(normal, a);
    float inexact = errorBound + HEIGHT_ROUNDING * far;
    // Of two triangles in one plane, the one that contains the hit is met: the other is farther by the error bounds.
    float beyond = min(products.x, min(products.y, products.z)) < 0.0 ? 2.0 * inexact : 0.0;
    float t = (max(height, 0.0) + beyond) / max(speed, 1e-20);
    bool isInside = products.x >= least.x && products.y >= least.y && products.z >= least.z;
    bool isAhead = speed > 0.0 && height >= (isSheet(face) ? inexact : -inexact);
    if (isInside && isAhead && t < nearest) {
        nearest = t;
        met = float(at);
    }
}

// Leaves the block of `skip` cells on each side of a cell, along the line from q, in the grid's coordinates, along d.
void leaveCells(float skip, vec3 q, vec3 d, vec3 inverse, vec3 sides, float size, inout float t, inout vec3 cell) {
    vec3 faces = (cell + mix(vec3(1.0 - skip), vec3(skip), sides)) * size;
    vec3 ways = (faces - q) * inverse;
    float way = min(ways.x, min(ways.y, ways.z));
    t = max(t, way);
    vec3 within = clamp(floor((q + t * d) / size), cell - (skip - 1.0), cell + (skip - 1.0));
    vec3 beyond = cell + mix(vec3(-skip), vec3(skip), sides);
    cell = mix(within, beyond, step(ways, vec3(way)));
}

// The distance from p along d to the nearest face whose air side the line meets, or NO_HIT beyond limit. Sets
// meshTriangle.
//
// Sphere tracing with an exact end: a line leaves the free cells around its cell at once, and is intersected with the
// triangles of the other cells. A hit beyond the cell is kept: the line ends there unless a nearer face is met before.
float hitMesh(vec3 p, vec3 d, float errorBound, float limit, int first) {
    vec4 grid = sceneData(first);
    vec3 count = sceneData(first + 1).xyz;
    vec4 places = sceneData(first + 2);
    int cells = first + int(places.x);
    int lists = first + int(places.y);
    int triangles = first + int(places.z);
    float size = grid.w;
    vec3 q = p - grid.xyz;
    vec3 sides = step(vec3(0.0), d);
    vec3 inverse = safeInverse(d);
    vec3 last = count - 1.0;
    vec3 enters = (mix(count, vec3(0.0), sides) * size - q) * inverse;
    vec3 leaves = (mix(vec3(0.0), count, sides) * size - q) * inverse;
    float t = max(max(enters.x, max(enters.y, enters.z)), 0.0);
    float end = min(leaves.x, min(leaves.y, leaves.z));
    float nearest = limit;
    float met = -1.0;
    vec3 cell = clamp(floor((q + t * d) / size), vec3(0.0), last);
    int most = 2 * int(count.x + count.y + count.z);   // rounding may lead back by a cell
    bool isWithin = t <= end;
    for (int i = 0; i < most && isWithin; ++i) {
        // Waves that are drawn together take the time of the slowest, so all of them fly to their next lists first.
        float word = meshCell(cell, count, cells);
        for (; i < most && isWithin && word >= 0.0; ++i) {
            leaveCells(max(floor(word), 1.0), q, d, inverse, sides, size, t, cell);
            vec3 held = clamp(cell, vec3(0.0), last);
            isWithin = t < nearest && cell == held;
            word = meshCell(held, count, cells);
        }
        int list = isWithin && word < 0.0 ? lists + int(-1.0 - word) : -1;
        while (list >= 0) {
            vec4 listed = sceneData(list);
            vec3 left = listed.xyz;   // triangles that are not met yet
            while (left.x >= 0.0) {
                meetTriangle(triangles + 4 * int(left.x), p, d, errorBound, nearest, met);
                left = vec3(left.yz, -1.0);
            }
            list = listed.w > 0.0 ? list + 1 : -1;
        }
        leaveCells(1.0, q, d, inverse, sides, size, t, cell);
        isWithin = isWithin && t < nearest && cell == clamp(cell, vec3(0.0), last);
    }
    if (met >= 0.0) {
        meshTriangle = met;
    }
    return met >= 0.0 ? nearest : NO_HIT;
}

// The point of the last hit on the line from p along d, moved onto the triangle and away from its edges, and the
// normal there.
void projectMesh(vec3 p, vec3 d, float errorBound, out vec3 onto, out vec3 normal) {
    int at = int(meshTriangle);
    vec4 plane = sceneData(at);
    vec4 u = sceneData(at + 1);
    vec4 v = sceneData(at + 2);
    vec4 w = sceneData(at + 3);
    vec3 toB = v.xyz - u.xyz;
    vec3 toC = w.xyz - u.xyz;
    vec3 across = cross(toB, toC);
    float squared = max(dot(across, across), 1e-30);
    vec3 a = u.xyz - p;
    float speed = max(-dot(plane.xyz, d), 1e-20);
    vec3 from = max(-dot(plane.xyz, a), 0.0) / speed * d - a;
    from -= plane.xyz * dot(plane.xyz, from);
    vec2 inner = vec2(dot(cross(from, toC), across), dot(cross(toB, from), across)) / squared;
    vec3 shares = vec3(1.0 - inner.x - inner.y, inner);
    vec3 least = min(MESH_INSET * errorBound * vec3(v.w, w.w, u.w) * inversesqrt(squared), vec3(1.0 / 3.0));
    vec3 held = max(shares, least);
    held /= held.x + held.y + held.z;
    onto = u.xyz + (all(greaterThanEqual(shares, least)) ? from : held.y * toB + held.z * toC);
    normal = plane.xyz;
    meshGroup = floor(plane.w);
}

// The vector from p to the nearest point of the triangle a, b, c relative to p.
vec3 towardsTriangle(vec3 a, vec3 b, vec3 c) {
    vec3 ab = b - a;
    vec3 ac = c - a;
    vec3 bc = c - b;
    vec3 normal = cross(ab, ac);
    bool isOver = dot(cross(normal, ab), a) <= 0.0 && dot(cross(normal, bc), b) <= 0.0
        && dot(cross(normal, -ac), c) <= 0.0;
    vec3 onAb = a + ab * clamp(-dot(a, ab) / dot(ab, ab), 0.0, 1.0);
    vec3 onAc = a + ac * clamp(-dot(a, ac) / dot(ac, ac), 0.0, 1.0);
    vec3 onBc = b + bc * clamp(-dot(b, bc) / dot(bc, bc), 0.0, 1.0);
    vec3 edge = dot(onAb, onAb) < dot(onAc, onAc) ? onAb : onAc;
    edge = dot(onBc, onBc) < dot(edge, edge) ? onBc : edge;
    return isOver ? normal * (dot(normal, a) / dot(normal, normal)) : edge;
}

// Keeps the triangle at index `at` if it is nearer to p. Of triangles at one distance, the one that p is the most
// in front of or behind decides on which side p is.
void nearerTriangle(int at, vec3 p, inout float nearest, inout float side) {
    const float ALIKE = 1e-5;   // of squared distances to a common edge or corner, relative
    vec4 face = sceneData(at);
    vec3 a = sceneData(at + 1).xyz - p;
    vec3 way = towardsTriangle(a, sceneData(at + 2).xyz - p, sceneData(at + 3).xyz - p);
    float squared = dot(way, way);
    float height = -dot(face.xyz, a);
    height = isSheet(face) ? abs(height) : height;
    bool isNearer = squared < nearest * (1.0 - ALIKE);
    bool isAlike = squared <= nearest * (1.0 + ALIKE) && abs(height) > abs(side);
    side = isNearer || isAlike ? height : side;
    nearest = min(nearest, squared);
}

// A lower bound of the distance to the mesh, negative in the solid: the distance itself within half a cell.
float sdMesh(vec3 p, int first) {
    vec4 grid = sceneData(first);
    vec4 shape = sceneData(first + 1);
    vec3 count = shape.xyz;
    vec4 places = sceneData(first + 2);
    int cells = first + int(places.x);
    int lists = first + int(places.y);
    int triangles = first + int(places.z);
    float size = grid.w;
    vec3 q = (p - grid.xyz) / size;
    vec3 held = clamp(q, vec3(0.0), count);
    float outside = size * length(q - held);
    vec3 last = count - 1.0;
    vec3 cell = clamp(floor(held), vec3(0.0), last);
    float word = meshCell(cell, count, cells);
    vec3 within = held - cell;
    vec3 margin = min(within, 1.0 - within);
    float gap = min(margin.x, min(margin.y, margin.z));
    float skip = floor(word);
    float sign = outside > 0.0 ? shape.w : word - skip > 0.25 ? -1.0 : 1.0;
    if (word >= 2.0 || outside > size) {
        float free = word >= 2.0 ? size * (skip - 1.0 + gap) : 0.0;
        return sign * max(free, outside);
    }
    float nearest = 1e30;
    float side = 1.0;
    vec3 low = floor(held - 0.5);
    for (int corner = 0; corner < 8; ++corner) {
        vec3 other = low + vec3(float(corner & 1), float((corner >> 1) & 1), float(corner >> 2));
        float near = other == clamp(other, vec3(0.0), last) ? meshCell(other, count, cells) : 1.0;
        int list = near < 0.0 ? lists + int(-1.0 - near) : -1;
        while (list >= 0) {
            vec4 listed = sceneData(list);
            nearerTriangle(triangles + 4 * int(listed.x), p, nearest, side);
            if (listed.y >= 0.0) {
                nearerTriangle(triangles + 4 * int(listed.y), p, nearest, side);
            }
            if (listed.z >= 0.0) {
                nearerTriangle(triangles + 4 * int(listed.z), p, nearest, side);
            }
            list = listed.w > 0.0 ? list + 1 : -1;
        }
    }
    bool isSolid = nearest < 1e30 ? side < 0.0 : sign < 0.0;
    // All triangles within half a cell are in these lists.
    float value = min(sqrt(nearest), 0.5 * size + outside);
    return isSolid ? -value : value;
}
