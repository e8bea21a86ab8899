// Barth's decic for POV-Ray 3.7: the same formula, ball, camera and colours as configs/barth_decic.toml,
// with the bound of the gradient that POV-Ray takes if none is given. `just beside-povray` renders it.
#version 3.7;

#include "camera.inc"  // Eye, Right, Up, Forward: written by the example

global_settings { assumed_gamma 1 }
background { rgb 1 }
camera { perspective location Eye right 2 * Right up 2 * Up direction Forward }

#declare G = (1 + sqrt(5)) / 2;
#declare F = function(x, y, z, s) {
    8 * (x * x - pow(G, 4) * y * y) * (y * y - pow(G, 4) * z * z) * (z * z - pow(G, 4) * x * x)
      * (pow(x, 4) + pow(y, 4) + pow(z, 4) - 2 * x * x * y * y - 2 * x * x * z * z - 2 * y * y * z * z)
      + (3 + 5 * G) * pow(s - 1, 2) * pow(s - (2 - G), 2)
}

isosurface {
    function { F(x, y, z, x * x + y * y + z * z) }
    contained_by { sphere { 0, 2 } }
    open
    no_shadow
    texture { pigment { srgb <181, 83, 60> / 255 } finish { ambient 0.08 diffuse 0.8 } }
    interior_texture { pigment { srgb <217, 176, 141> / 255 } finish { ambient 0.08 diffuse 0.8 } }
}

light_source {
    100 * vnormalize(-0.25 * vnormalize(Right) + 0.4 * vnormalize(Up) - Forward)
    color rgb 1
    parallel
    point_at 0
}
