// "No hit" as a distance along a ray, in metres: greater than every other number here.
const float NO_HIT = 1e30;
