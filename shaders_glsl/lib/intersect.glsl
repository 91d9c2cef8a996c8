// Ray against box and ray against triangle, with bounds on what rounding may do.
//
// Box: slabs with the far side grown by the error of its own arithmetic (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013), so that
// what a triangle test accepts never lies in a box that was passed by.
// Triangle: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Deviations: both windings hit, so axes are
// never swapped; and an edge function of exactly zero counts as inside instead of being evaluated again in double precision. Rounded
// products keep the order of the exact ones, so an edge function never has the wrong sign, only sometimes none: a ray that
// meets an edge hits at least one of its triangles, perhaps both, at the same distance.
// A hit counts only where the triangle's plane lies ahead by more than rounding can make of 0 (Pharr, Jakob and Humphreys, "Physically Based
// Rendering", 4th edition, section 6.8.7, bound the distance instead, by millimetres for slivers of metres, which rays then leave through).
#ifndef LIB_INTERSECT_GLSL
#define LIB_INTERSECT_GLSL

/// 1 / direction, finite: components nearer to zero than 1e-30 count as that, so that a box's side that the origin lies on is never
/// zero times infinity.
vec3 finite_reciprocal(vec3 direction) {
    vec3 least = mix(vec3(-1e-30), vec3(1e-30), greaterThanEqual(direction, vec3(0.0)));
    return 1.0 / mix(direction, least, lessThan(abs(direction), vec3(1e-30)));
}

/// What `intersect_box` returns for a miss: no box is entered there or behind.
const float MISSED = 3.4028235e38;

/// min and max of numbers: the built-in ones look for NaN on a software driver, at two more instructions each.
float smaller(float a, float b) {
    return a < b ? a : b;
}

float larger(float a, float b) {
    return a > b ? a : b;
}

/// Where the ray enters the box, at least t_min; MISSED where it does not in (t_min, t_max).
float intersect_box(vec3 origin, vec3 reciprocal, float t_min, float t_max, vec3 box_min, vec3 box_max) {
    bvec3 backwards = lessThan(reciprocal, vec3(0.0));
    vec3 lower = (mix(box_min, box_max, backwards) - origin) * reciprocal;
    vec3 upper = (mix(box_max, box_min, backwards) - origin) * reciprocal;
    float near = larger(larger(lower.x, lower.y), larger(lower.z, t_min));
    float far = smaller(smaller(upper.x, upper.y), smaller(upper.z, t_max));
    // 1 + 2 gamma(3): three roundings on each side.
    return near <= far * 1.0000004 ? near : MISSED;
}

/// A ray's own half of the watertight test, but for its origin: its direction's largest component becomes z, and the shear makes it the z axis.
struct TriangleRay {
    /// x / z, y / z, 1 / z of the permuted direction.
    vec3 shear;
    uint axis;
};

/// Puts component `axis` last and keeps the handedness.
vec3 axis_last(vec3 v, uint axis) {
    return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v;
}

TriangleRay triangle_ray(vec3 direction) {
    vec3 size = abs(direction);
    uint axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    vec3 d = axis_last(direction, axis);
    return TriangleRay(vec3(d.xy / d.z, 1.0 / d.z), axis);
}

/// Whether the triangle's plane lies ahead of the ray's origin by more than rounding can make of 0. A hit's distance is a weighted sum of
/// depths, whose error grows with the triangle's aspect ratio; the side of the plane is known much better. The normal comes from the two
/// shorter edges, which are nearly perpendicular in a needle.
///
/// Error of dot(normal, to_plane): edges and to_plane have 1 rounding, the normal's products and difference 2, the dot product 3: with
/// the edges' both, 7 of at most `largest` times |to_plane|, and some to spare.
bool lies_ahead(vec3 origin, vec3 direction, vec3 p0, vec3 p1, vec3 p2) {
    const float roundings = 9.0 * 5.9604645e-8;
    vec3 edges[3] = vec3[3](p2 - p1, p0 - p2, p1 - p0);
    vec3 lengths = vec3(dot(edges[0], edges[0]), dot(edges[1], edges[1]), dot(edges[2], edges[2]));
    bool first = lengths.x >= max(lengths.y, lengths.z);
    bool second = !first && lengths.y >= lengths.z;
    // The corner opposite to the longest edge, and the edges that meet there.
    vec3 to_plane = (first ? p0 : second ? p1 : p2) - origin;
    vec3 a = first ? edges[1] : second ? edges[2] : edges[0];
    vec3 b = first ? edges[2] : second ? edges[0] : edges[1];
    precise vec3 normal = a.yzx * b.zxy - a.zxy * b.yzx;
    vec3 largest = abs(a.yzx * b.zxy) + abs(a.zxy * b.yzx);
    precise float side = dot(normal, to_plane);
    return side * sign(dot(normal, direction)) > roundings * dot(largest, abs(to_plane));
}

/// Distance, and barycentrics of p1 and p2, of a hit in (t_min, t_max).
bool intersect_watertight(
    vec3 origin, TriangleRay ray, vec3 p0, vec3 p1, vec3 p2, float t_min, float t_max, out float t, out vec2 barycentrics
) {
    vec3 a = axis_last(p0 - origin, ray.axis);
    vec3 b = axis_last(p1 - origin, ray.axis);
    vec3 c = axis_last(p2 - origin, ray.axis);
    // Fused operations would round one triangle's half of an edge unlike its neighbour's.
    precise vec2 a2 = a.xy - ray.shear.xy * a.z;
    precise vec2 b2 = b.xy - ray.shear.xy * b.z;
    precise vec2 c2 = c.xy - ray.shear.xy * c.z;
    precise vec3 edges = vec3(c2.x * b2.y - c2.y * b2.x, a2.x * c2.y - a2.y * c2.x, b2.x * a2.y - b2.y * a2.x);
    float least = min(edges.x, min(edges.y, edges.z));
    float most = max(edges.x, max(edges.y, edges.z));
    float inverse = 1.0 / (edges.x + edges.y + edges.z);
    t = dot(edges, vec3(a.z, b.z, c.z)) * ray.shear.z * inverse;
    barycentrics = edges.yz * inverse;
    // Edge-on, all edges are zero and t is no number: the comparisons fail.
    return (least >= 0.0 || most <= 0.0) && t > t_min && t < t_max;
}

/// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997. Same contract; rays may pass between triangles.
bool intersect_moeller_trumbore(
    vec3 origin, vec3 direction, vec3 p0, vec3 p1, vec3 p2, float t_min, float t_max, out float t, out vec2 barycentrics
) {
    vec3 edge1 = p1 - p0;
    vec3 edge2 = p2 - p0;
    vec3 across = cross(direction, edge2);
    float inverse = 1.0 / dot(edge1, across);
    vec3 to_origin = origin - p0;
    vec3 normal = cross(to_origin, edge1);
    barycentrics = vec2(dot(to_origin, across), dot(direction, normal)) * inverse;
    t = dot(edge2, normal) * inverse;
    return barycentrics.x >= 0.0 && barycentrics.y >= 0.0 && barycentrics.x + barycentrics.y <= 1.0 && t > t_min && t < t_max;
}

#endif
