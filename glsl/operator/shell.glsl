float opShell(float a, float halfThickness) { return abs(a) - halfThickness; }
