// Values of POV-Ray's functions, for tests/povray.rs: each call, and what it gives at eight places.
//
//     povray tests/povray/values.pov +W1 +H1 -F -D 2>&1 | grep -E '^(f_|at )' > tests/povray/values.txt

#version 3.7;
#include "functions.inc"

// Places that are no special ones, within R of the origin along each axis.
#macro Show(Call, R)
  #debug concat(Call, "\n")
  #local I = 1;
  #while (I <= 8)
    #local X = R*(2*mod(I*sqrt(2), 1) - 1);
    #local Y = R*(2*mod(I*sqrt(3), 1) - 1);
    #local Z = R*(2*mod(I*sqrt(5), 1) - 1);
    #debug concat("at ", str(R, 0, 1), " ", str(I, 0, 0), ": ", str(F(X, Y, Z), 0, 12), "\n")
    #local I = I + 1;
  #end
  #undef F
#end

#declare F = function { f_algbr_cyl1(x, y, z, 1, 5, 0, 0, 0) }
Show("f_algbr_cyl1(x, y, z, 1, 5, 0, 0, 0)", 2)
#declare F = function { f_algbr_cyl1(x, y, z, 1, 5, 1, 0.5, 30) }
Show("f_algbr_cyl1(x, y, z, 1, 5, 1, 0.5, 30)", 2)
#declare F = function { f_algbr_cyl2(x, y, z, 1, 5, 1, 0, 0) }
Show("f_algbr_cyl2(x, y, z, 1, 5, 1, 0, 0)", 2)
#declare F = function { f_algbr_cyl3(x, y, z, 2, 5, 1, 1, 45) }
Show("f_algbr_cyl3(x, y, z, 2, 5, 1, 1, 45)", 2)
#declare F = function { f_algbr_cyl4(x, y, z, -1, 5, 1, 0, -20) }
Show("f_algbr_cyl4(x, y, z, -1, 5, 1, 0, -20)", 2)
#declare F = function { f_bicorn(x, y, z, -1, 1) }
Show("f_bicorn(x, y, z, -1, 1)", 2)
#declare F = function { f_bifolia(x, y, z, -1, 3) }
Show("f_bifolia(x, y, z, -1, 3)", 2)
#declare F = function { f_blob(x, y, z, 1, 1, 1.1, 0.8, 0.9) }
Show("f_blob(x, y, z, 1, 1, 1.1, 0.8, 0.9)", 2)
#declare F = function { f_blob2(x, y, z, 1.5, 2, 2, 1) }
Show("f_blob2(x, y, z, 1.5, 2, 2, 1)", 3)
#declare F = function { f_boy_surface(x, y, z, -0.001, 1) }
Show("f_boy_surface(x, y, z, -0.001, 1)", 2)
#declare F = function { f_comma(x, y, z, 1.2) }
Show("f_comma(x, y, z, 1.2)", 2)
#declare F = function { f_cross_ellipsoids(x, y, z, 0.1, 1, 1, 0.5) }
Show("f_cross_ellipsoids(x, y, z, 0.1, 1, 1, 0.5)", 4)
#declare F = function { f_crossed_trough(x, y, z, 1) }
Show("f_crossed_trough(x, y, z, 1)", 2)
#declare F = function { f_cubic_saddle(x, y, z, 1) }
Show("f_cubic_saddle(x, y, z, 1)", 2)
#declare F = function { f_cushion(x, y, z, -1) }
Show("f_cushion(x, y, z, -1)", 2)
#declare F = function { f_devils_curve(x, y, z, -1) }
Show("f_devils_curve(x, y, z, -1)", 2)
#declare F = function { f_devils_curve_2d(x, y, z, -1, 1, 0.8, 1, 0.3, 15) }
Show("f_devils_curve_2d(x, y, z, -1, 1, 0.8, 1, 0.3, 15)", 2)
#declare F = function { f_dupin_cyclid(x, y, z, -0.0001, 6, 0.5, 3, 0.2, 3) }
Show("f_dupin_cyclid(x, y, z, -0.0001, 6, 0.5, 3, 0.2, 3)", 4)
#declare F = function { f_ellipsoid(x, y, z, 1, 0.7, 1.5) }
Show("f_ellipsoid(x, y, z, 1, 0.7, 1.5)", 2)
// f_enneper of POV-Ray 3.7 is another one than that of 3.8.
#declare F = function { f_flange_cover(x, y, z, 0.01, 3, 0.8, 1) }
Show("f_flange_cover(x, y, z, 0.01, 3, 0.8, 1)", 4)
#declare F = function { f_folium_surface(x, y, z, 1, 1, 1) }
Show("f_folium_surface(x, y, z, 1, 1, 1)", 2)
#declare F = function { f_folium_surface_2d(x, y, z, -1, 2, 1, 1, 0.5, 60) }
Show("f_folium_surface_2d(x, y, z, -1, 2, 1, 1, 0.5, 60)", 2)
#declare F = function { f_glob(x, y, z, -1) }
Show("f_glob(x, y, z, -1)", 2)
#declare F = function { f_heart(x, y, z, -1) }
Show("f_heart(x, y, z, -1)", 2)
#declare F = function { f_helical_torus(x, y, z, 1.3, 8, 1, 0.1, 0.2, 0.3, 0.2, 3, 1, 2) }
Show("f_helical_torus(x, y, z, 1.3, 8, 1, 0.1, 0.2, 0.3, 0.2, 3, 1, 2)", 2.5)
#declare F = function { f_helix1(x, y, z, 2, 4, 0.15, 1, 1, 1, 0) }
Show("f_helix1(x, y, z, 2, 4, 0.15, 1, 1, 1, 0)", 2)
#declare F = function { f_helix1(x, y, z, 1, 5, 0.2, 1, 1.5, 0, 30) }
Show("f_helix1(x, y, z, 1, 5, 0.2, 1, 1.5, 0, 30)", 2)
#declare F = function { f_helix1(x, y, z, 3, 3, 0.15, 1, 1, 0.5, 0) }
Show("f_helix1(x, y, z, 3, 3, 0.15, 1, 1, 0.5, 0)", 2)
#declare F = function { f_helix2(x, y, z, 0, 4, 0.5, 0.3, 0, 0, 0) }
Show("f_helix2(x, y, z, 0, 4, 0.5, 0.3, 0, 0, 0)", 2)
#declare F = function { f_hex_x(x, y, z, 0) }
Show("f_hex_x(x, y, z, 0)", 4)
#declare F = function { f_hex_y(x, y, z, 0) }
Show("f_hex_y(x, y, z, 0)", 4)
#declare F = function { f_hunt_surface(x, y, z, -0.001) }
Show("f_hunt_surface(x, y, z, -0.001)", 5)
#declare F = function { f_hyperbolic_torus(x, y, z, -1, 0.6, 0.4) }
Show("f_hyperbolic_torus(x, y, z, -1, 0.6, 0.4)", 2)
#declare F = function { f_isect_ellipsoids(x, y, z, 0.1, 1, 1, 0.5) }
Show("f_isect_ellipsoids(x, y, z, 0.1, 1, 1, 0.5)", 2)
#declare F = function { f_kampyle_of_eudoxus(x, y, z, -1, 0.2, 1) }
Show("f_kampyle_of_eudoxus(x, y, z, -1, 0.2, 1)", 2)
#declare F = function { f_kampyle_of_eudoxus_2d(x, y, z, -1, 0.4, 1.5, 1, 0, 25) }
Show("f_kampyle_of_eudoxus_2d(x, y, z, -1, 0.4, 1.5, 1, 0, 25)", 2)
#declare F = function { f_klein_bottle(x, y, z, -1) }
Show("f_klein_bottle(x, y, z, -1)", 5)
#declare F = function { f_kummer_surface_v1(x, y, z, -1) }
Show("f_kummer_surface_v1(x, y, z, -1)", 3)
#declare F = function { f_kummer_surface_v2(x, y, z, -1, -1.3, -1, 0.4) }
Show("f_kummer_surface_v2(x, y, z, -1, -1.3, -1, 0.4)", 3)
#declare F = function { f_lemniscate_of_gerono(x, y, z, -1) }
Show("f_lemniscate_of_gerono(x, y, z, -1)", 2)
#declare F = function { f_lemniscate_of_gerono_2d(x, y, z, -1, 1.2, 0.7, 1, 0.2, 80) }
Show("f_lemniscate_of_gerono_2d(x, y, z, -1, 1.2, 0.7, 1, 0.2, 80)", 2)
#declare F = function { f_mesh1(x, y, z, 0.5, 0.6, 1, 0.1, 1.2) }
Show("f_mesh1(x, y, z, 0.5, 0.6, 1, 0.1, 1.2)", 1)
#declare F = function { f_mitre(x, y, z, -1) }
Show("f_mitre(x, y, z, -1)", 2)
#declare F = function { f_nodal_cubic(x, y, z, -1) }
Show("f_nodal_cubic(x, y, z, -1)", 2)
#declare F = function { f_odd(x, y, z, -1) }
Show("f_odd(x, y, z, -1)", 2)
#declare F = function { f_ovals_of_cassini(x, y, z, -1, 0.5, 0.24, 6) }
Show("f_ovals_of_cassini(x, y, z, -1, 0.5, 0.24, 6)", 2)
#declare F = function { f_paraboloid(x, y, z, -1) }
Show("f_paraboloid(x, y, z, -1)", 2)
#declare F = function { f_parabolic_torus(x, y, z, -1, 0.6, 0.5) }
Show("f_parabolic_torus(x, y, z, -1, 0.6, 0.5)", 2)
#declare F = function { f_ph(x, y, z) }
Show("f_ph(x, y, z)", 2)
#declare F = function { f_pillow(x, y, z, 1) }
Show("f_pillow(x, y, z, 1)", 2)
#declare F = function { f_piriform(x, y, z, 1) }
Show("f_piriform(x, y, z, 1)", 2)
#declare F = function { f_piriform_2d(x, y, z, -1, 1, -1, 1, 1, 0.3, 20) }
Show("f_piriform_2d(x, y, z, -1, 1, -1, 1, 1, 0.3, 20)", 2)
#declare F = function { f_poly4(x, y, z, 0.5, 0.1, 0.3, -0.1, -0.4) }
Show("f_poly4(x, y, z, 0.5, 0.1, 0.3, -0.1, -0.4)", 2)
#declare F = function { f_polytubes(x, y, z, 5, 0.8, 0.1, 0.2, 0, -0.1) }
Show("f_polytubes(x, y, z, 5, 0.8, 0.1, 0.2, 0, -0.1)", 2)
#declare F = function { f_quantum(x, y, z, 0) }
Show("f_quantum(x, y, z, 0)", 5)
#declare F = function { f_quartic_paraboloid(x, y, z, -1) }
Show("f_quartic_paraboloid(x, y, z, -1)", 2)
#declare F = function { f_quartic_saddle(x, y, z, -1) }
Show("f_quartic_saddle(x, y, z, -1)", 2)
#declare F = function { f_quartic_cylinder(x, y, z, -1, 1, 0.5) }
Show("f_quartic_cylinder(x, y, z, -1, 1, 0.5)", 2)
#declare F = function { f_r(x, y, z) }
Show("f_r(x, y, z)", 2)
#declare F = function { f_rounded_box(x, y, z, 0.2, 1, 0.8, 0.6) }
Show("f_rounded_box(x, y, z, 0.2, 1, 0.8, 0.6)", 2)
#declare F = function { f_sphere(x, y, z, 1.2) }
Show("f_sphere(x, y, z, 1.2)", 2)
#declare F = function { f_spikes(x, y, z, 0.05, 2, -1, 1, 2) }
Show("f_spikes(x, y, z, 0.05, 2, -1, 1, 2)", 2)
#declare F = function { f_spikes_2d(x, y, z, 1, 4, 3, 0.5) }
Show("f_spikes_2d(x, y, z, 1, 4, 3, 0.5)", 2)
#declare F = function { f_spiral(x, y, z, 0.6, 0.15, 1.8, 0, 0, 1) }
Show("f_spiral(x, y, z, 0.6, 0.15, 1.8, 0, 0, 1)", 2)
#declare F = function { f_spiral(x, y, z, 0.7, 0.2, 1.5, 0, 0, 0) }
Show("f_spiral(x, y, z, 0.7, 0.2, 1.5, 0, 0, 0)", 2)
#declare F = function { f_spiral(x, y, z, 0.5, 0.1, 1.5, 0, 0, 0.6) }
Show("f_spiral(x, y, z, 0.5, 0.1, 1.5, 0, 0, 0.6)", 2)
#declare F = function { f_steiners_roman(x, y, z, -1) }
Show("f_steiners_roman(x, y, z, -1)", 1)
#declare F = function { f_strophoid(x, y, z, -1, 1, 0.3, 1.2) }
Show("f_strophoid(x, y, z, -1, 1, 0.3, 1.2)", 2)
#declare F = function { f_strophoid_2d(x, y, z, -1, 1, 0.3, 1.2, 1, 0.4, 10) }
Show("f_strophoid_2d(x, y, z, -1, 1, 0.3, 1.2, 1, 0.4, 10)", 2)
#declare F = function { f_superellipsoid(x, y, z, 0.5, 1.5) }
Show("f_superellipsoid(x, y, z, 0.5, 1.5)", 2)
#declare F = function { f_th(x, y, z) }
Show("f_th(x, y, z)", 2)
#declare F = function { f_torus(x, y, z, 1.1, 0.4) }
Show("f_torus(x, y, z, 1.1, 0.4)", 2)
#declare F = function { f_torus2(x, y, z, -1, 1.1, 0.4) }
Show("f_torus2(x, y, z, -1, 1.1, 0.4)", 2)
#declare F = function { f_torus_gumdrop(x, y, z, -1) }
Show("f_torus_gumdrop(x, y, z, -1)", 3)
#declare F = function { f_umbrella(x, y, z, -1) }
Show("f_umbrella(x, y, z, -1)", 2)
#declare F = function { f_witch_of_agnesi(x, y, z, -1, 0.3) }
Show("f_witch_of_agnesi(x, y, z, -1, 0.3)", 2)
#declare F = function { f_witch_of_agnesi_2d(x, y, z, -1, 0.4, 0.3, 1, 0.5, 10) }
Show("f_witch_of_agnesi_2d(x, y, z, -1, 0.4, 0.3, 1, 0.5, 10)", 2)
#declare F = function { f_sine_wave(x, y, z) }
Show("f_sine_wave(x, y, z)", 2)
#declare F = function { f_scallop_wave(x, y, z) }
Show("f_scallop_wave(x, y, z)", 2)
