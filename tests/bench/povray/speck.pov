#version 3.7;
#include "precision.inc"
Look(<0, 0, -1>, 4e-6)
sphere { <0, 0, 0>, 1e-6 pigment { First } }
