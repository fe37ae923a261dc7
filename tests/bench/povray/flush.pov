#version 3.7;
#include "precision.inc"
Look(<1.25, 1.5, -4.5>, 4.75)
difference {
  box { <-1, -1, -1>, <1, 1, 1> pigment { First } }
  cylinder { <0, 0, -1>, <0, 0, 1>, 0.75 pigment { Second } }
  scale Size
  translate Away*<1, 1, 1>
}
