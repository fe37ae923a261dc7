#version 3.7;
#include "precision.inc"
Look(<1.25, 1.5, -4.5>, 4.75)
difference {
  union {
    box { <-1, -1, -1>, <0, 1, 1> pigment { First } }
    box { <0, -1, -1>, <1, 1, 1> pigment { Second } }
  }
  box { <0, 0, -2>, <2, 2, 2> }
  cutaway_textures
}
