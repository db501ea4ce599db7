// "Met nothing" as a distance along a ray, in metres: beyond every other number here.
const float NO_HIT = 1e30;
