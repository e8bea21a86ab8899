// Scene 1 for POV-Ray 3.7: the same formula, box, camera and colour as configs/scene1.toml.
// `just beside-povray` renders it. Declare= sets
//   Bound    what is promised of |grad F|: no ray meets what changes faster
//   Normals  0: a lit picture; 1 or -1: linear red, green and blue are the components of the normal
//            to the right, up and to the viewer, times this number; what is below 0 is black
#version 3.7;
#ifndef (Bound) #declare Bound = 5.9; #end
#ifndef (Normals) #declare Normals = 0; #end

#include "camera.inc"  // Eye, Right, Up, Forward: written by the example

global_settings { assumed_gamma 1 }
background { rgb (Normals ? 0 : 1) }
camera { perspective location Eye right 2 * Right up 2 * Up direction Forward }

#declare Ball = function(x, y, z, A) { pow(max(0, 1 - A * A * (x * x + y * y + z * z)), 4) }
#declare F = function {
    0.25
    - Ball(x,        y,        z,        1.60)
    - Ball(x - 0.42, y - 0.05, z - 0.12, 2.20)
    - Ball(x + 0.40, y - 0.10, z + 0.10, 2.10)
    - Ball(x - 0.06, y - 0.44, z + 0.08, 2.30)
    - Ball(x + 0.05, y + 0.43, z - 0.10, 2.20)
    - Ball(x - 0.08, y + 0.06, z - 0.46, 2.40)
    - Ball(x + 0.10, y - 0.04, z + 0.45, 2.30)
    - Ball(x - 0.66, y - 0.26, z - 0.24, 2.90)
    - Ball(x + 0.58, y + 0.22, z + 0.34, 2.70)
    - Ball(x - 0.20, y - 0.62, z - 0.28, 2.80)
}

isosurface {
    function { F(x, y, z) }
    contained_by { box { -1, 1 } }
    max_gradient Bound
    accuracy 0.001
    no_shadow
    #if (Normals)
        pigment { rgb 1 }
        finish { ambient 0 diffuse 1 }
    #else
        pigment { srgb <232, 176, 75> / 255 }
        finish { ambient 0.08 diffuse 0.8 specular 0.3 roughness 1 / 32 }
    #end
}

#macro Lamp(Direction, Color)
    light_source { 100 * Direction color Color parallel point_at 0 }
#end
#if (Normals)
    Lamp(Normals * vnormalize(Right), red 1)
    Lamp(Normals * vnormalize(Up), green 1)
    Lamp(-Forward, blue 1)
#else
    Lamp(vnormalize(-0.25 * vnormalize(Right) + 0.4 * vnormalize(Up) - Forward), rgb 1)
#end
