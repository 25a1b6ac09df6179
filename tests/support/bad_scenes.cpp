// SPDX-License-Identifier: MIT
#include "support/bad_scenes.hpp"

#include <initializer_list>

namespace flotilla::test {
namespace {

std::string with(const std::string& top, const std::string& shapes, const std::string& bodies) {
    return "{\"flotilla_scene\": 1" + (top.empty() ? "" : ", " + top) + ", \"shapes\": [" + shapes +
           "], \"bodies\": [" + bodies + "]}";
}
const std::string kSurface = R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]])";
const std::string kShape = R"({"name": "s", )" + kSurface + R"(, "mass": 1})";
const std::string kBody = R"({"name": "b", "shape": "s"})";

std::string top(const std::string& members) { return with(members, kShape, kBody); }
std::string settings(const std::string& members) { return top("\"settings\": {" + members + "}"); }
std::string shape(const std::string& members) {
    return with("", R"({"name": "s", )" + kSurface + (members.empty() ? "" : ", " + members) + "}", kBody);
}
std::string surface(const std::string& members) {
    return with("", R"({"name": "s", "mass": 1, )" + members + "}", kBody);
}
std::string body(const std::string& members) {
    return with("", kShape, R"({"name": "b", "shape": "s", )" + members + "}");
}
std::string keyframes(const std::string& list) { return body(R"("type": "kinematic", "keyframes": [)" + list + "]"); }

// What the text itself gets wrong.
std::vector<BadScene> bad_text() {
    return {
        {"empty file",
         "",
         {"line 1, column 1: syntax error while parsing value - unexpected end of input; expected '[', '{', or a "
          "literal"}},
        {"truncated",
         "{\"flotilla_scene\": 1,\n\"shapes\": [",
         {"line 2, column 12: syntax error while parsing value - unexpected end of input; expected '[', '{', or a "
          "literal"}},
        {"not JSON",
         "shapes: []",
         {"line 1, column 1: syntax error while parsing value - invalid literal; last read: 's'"}},
        {"trailing text",
         "{\"flotilla_scene\": 1} x",
         {"line 1, column 23: syntax error while parsing value - invalid literal; last read: '1} x'; expected end of "
          "input"}},
        {"NaN",
         "{\"gravity\": [0, NaN, 0]}",
         {"line 1, column 17: syntax error while parsing value - invalid literal; last read: '0, N'"}},
        {"number beyond double",
         "{\"flotilla_scene\": 1,\n \"gravity\": [0, 0, 1e999]}",
         {"line 2, column 20: number 1e999 is beyond the range of a double"}},
        {"duplicate key",
         top(R"("gravity": [0,0,0], "gravity": [0,0,1])"),
         {"/gravity: key given twice in one object"}},
        {"duplicate key in a body", body(R"("name": "c")"), {"/bodies/0/name: key given twice in one object"}},
        {"not an object", "[1, 2]", {"must be an object, got an array of 2"}},
    };
}

std::vector<BadScene> bad_top() {
    return {
        {"no version", R"({"shapes": [], "bodies": []})", {"/flotilla_scene: is missing"}},
        {"other version",
         R"({"flotilla_scene": 2, "shapes": [], "bodies": []})",
         {"/flotilla_scene: must be 1, the version of the format, got 2"}},
        {"version that is no whole number",
         R"({"flotilla_scene": 1.5, "shapes": [], "bodies": []})",
         {"/flotilla_scene: must be 1, the version of the format, got 1.5"}},
        {"missing lists", R"({"flotilla_scene": 1})", {"/shapes: is missing", "/bodies: is missing"}},
        {"lists of a wrong type",
         R"({"flotilla_scene": 1, "shapes": {}, "bodies": "none"})",
         {"/shapes: must be an array of shapes, got an object",
          "/bodies: must be an array of bodies, got the string \"none\""}},
        {"unknown key", top(R"("gravty": [0,0,0])"), {"/gravty: unknown key \"gravty\"; did you mean \"gravity\"?"}},
        {"gravity too short",
         top(R"("gravity": [0, -9.8])"),
         {"/gravity: must be an array of 3 numbers, got an array of 2"}},
        {"gravity with a string",
         top(R"("gravity": [0, 0, "down"])"),
         {"/gravity/2: must be a number, got the string \"down\""}},
        {"huge gravity",
         top(R"("gravity": [0, 0, -1e7])"),
         {"/gravity: component 1e+07 exceeds the limit of 1e+06 m/s^2"}},
        {"settings not an object", top(R"("settings": [])"), {"/settings: must be an object, got an array of 0"}},
        {"unknown setting",
         settings(R"("timestep": 0.1)"),
         {"/settings/timestep: unknown key \"timestep\"; did you mean \"time_step\"?"}},
        {"settings of a wrong type",
         settings(R"("sleeping": 1, "time_step": "0.1", "trajectory": true, "friction": null)"),
         {"/settings/friction: must be a number, a boolean or a string, got null",
          "/settings/sleeping: must be true or false, got 1", "/settings/time_step: must be a number, got \"0.1\"",
          "/settings/trajectory: must be one of linear, rigid; got true"}},
        {"settings out of range",
         settings(R"("time_step": -1, "restitution": 2, "static_iterations": 1.5)"),
         {"/settings/restitution: must be in 0 .. 1, got 2", "/settings/static_iterations: must be an integer, got 1.5",
          "/settings/time_step: must be in 1e-09 .. 10 s, got -1"}},
        {"settings that contradict",
         settings(R"("rest_distance": 0.01, "proximity_distance": 0.005)"),
         {"/settings/proximity_distance: must exceed rest_distance (0.01 m), got 0.005"}},
    };
}

std::vector<BadScene> bad_shapes() {
    const std::string no_name = "{" + kSurface + R"(, "mass": 1})";
    return {
        {"no name", with("", no_name, ""), {"/shapes/0/name: is missing"}},
        {"empty name", with("", R"({"name": "", )" + kSurface + "}", ""), {"/shapes/0/name: must not be empty"}},
        {"duplicate names",
         with("", kShape + "," + kShape, kBody),
         {"/shapes/1/name: \"s\" is already the name of /shapes/0"}},
        {"unknown key",
         shape(R"("mass": 1, "surface-density": 2)"),
         {"/shapes/0/surface-density: unknown key \"surface-density\"; did you mean \"surface_density\"?"}},
        {"mesh and vertices",
         surface(R"("mesh": "a.obj", )" + kSurface),
         {"/shapes/0/mesh: give either a mesh or vertices and triangles, not both"}},
        {"no surface",
         with("", R"({"name": "s", "mass": 1})", kBody),
         {"/shapes/0/mesh: is missing: a shape needs a mesh, or vertices and triangles"}},
        {"mesh path of a wrong type", surface(R"("mesh": 5)"), {"/shapes/0/mesh: must be a string, got 5"}},
        {"vertices without triangles", surface(R"("vertices": [[0,0,0]])"), {"/shapes/0/triangles: is missing"}},
        {"segments and points that are none",
         surface(R"("vertices": [[0,0,0],[1,0,0]], "segments": [[0,1],[1,1],[0,2],[0],[0,-1]], "points": [1,2,0.5])"),
         {"/shapes/0/segments/3: must be an array of 2 vertex numbers, got an array of 1",
          "/shapes/0/segments/4/1: must be a vertex number counted from 0, got -1",
          "/shapes/0/points/2: must be a vertex number counted from 0, got 0.5",
          "/shapes/0/triangles: must hold at least one triangle, unless there are segments or points"}},
        {"segments of no length",
         surface(R"("vertices": [[0,0,0],[1,0,0]], "segments": [[0,1],[1,1],[0,2]], "points": [1,2])"),
         {"/shapes/0/segments/1: has both ends at vertex 1",
          "/shapes/0/segments/2: vertex 2 does not exist; there are 2",
          "/shapes/0/points/1: vertex 2 does not exist; there are 2"}},
        {"no triangle",
         surface(R"("vertices": [[0,0,0]], "triangles": [])"),
         {"/shapes/0/triangles: must hold at least one triangle, unless there are segments or points"}},
        {"index out of range",
         surface(R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,3]])"),
         {"/shapes/0/triangles/0: vertex 3 does not exist; there are 3"}},
        {"bad indices",
         surface(R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,-2],[0,1,1.5],[0,1]])"),
         {"/shapes/0/triangles/0: must be an array of 3 vertex numbers counted from 0, got [0,1,-2]",
          "/shapes/0/triangles/1: must be an array of 3 vertex numbers counted from 0, got [0,1,1.5]",
          "/shapes/0/triangles/2: must be an array of 3 vertex numbers counted from 0, got an array of 2"}},
        {"vertex of 2 coordinates",
         surface(R"("vertices": [[0,0,0],[1,0],[0,1,0]], "triangles": [[0,1,2]])"),
         {"/shapes/0/vertices/1: must be an array of 3 numbers, got an array of 2"}},
        {"huge vertex",
         surface(R"("vertices": [[0,0,0],[1e10,0,0],[0,1,0]], "triangles": [[0,1,2]])"),
         {"/shapes/0/vertices/1: vertex 1, multiplied by scale, exceeds the limit of 1e+09 m"}},
        {"zero scale", shape(R"("mass": 1, "scale": 0)"), {"/shapes/0/scale: must be in 1e-09 .. 1e+09, got 0"}},
        {"tiny scale",
         shape(R"("mass": 1, "scale": 1e-300)"),
         {"/shapes/0/scale: must be in 1e-09 .. 1e+09, got 1e-300"}},
        {"zero mass", shape(R"("mass": 0)"), {"/shapes/0/mass: must be in 1e-12 .. 1e+15 kg, got 0"}},
        {"negative density",
         shape(R"("density": -5)"),
         {"/shapes/0/density: must be in 1e-12 .. 1e+15 kg/m^3, got -5"}},
        {"huge surface density",
         shape(R"("surface_density": 1e20)"),
         {"/shapes/0/surface_density: must be in 1e-12 .. 1e+15 kg/m^2, got 1e+20"}},
        {"two masses",
         shape(R"("mass": 1, "density": 2)"),
         {"/shapes/0/mass: give only one of surface_density, density, line_density and mass"}},
        {"inertia without mass",
         with("", R"({"name": "s", )" + kSurface + R"(, "inertia": [1,1,1]})", ""),
         {"/shapes/0/inertia: needs one of surface_density, density, line_density and mass"}},
        {"inertia of 4 numbers",
         shape(R"("mass": 1, "inertia": [1,1,1,1])"),
         {"/shapes/0/inertia: must be an array of 3 (principal values) or 9 (row-major) numbers, got an array of 4"}},
    };
}

std::vector<BadScene> bad_bodies() {
    return {
        {"unknown key",
         body(R"("positon": [0,0,0])"),
         {"/bodies/0/positon: unknown key \"positon\"; did you mean \"position\"?"}},
        {"unknown key resembling none", body(R"("colour": "red")"), {"/bodies/0/colour: unknown key \"colour\""}},
        {"key with a slash", body(R"("a/b~": 1)"), {"/bodies/0/a~1b~0: unknown key \"a/b~\""}},
        {"name with control characters",
         with("", kShape, R"({"name": "a\n", "shape": "s"})"),
         {"/bodies/0/name: must not contain control characters: \"a\\x0a\""}},
        {"name of a wrong type",
         with("", kShape, R"({"name": 7, "shape": "s"})"),
         {"/bodies/0/name: must be a string, got 7"}},
        {"duplicate names",
         with("", kShape, kBody + "," + kBody),
         {"/bodies/1/name: \"b\" is already the name of /bodies/0"}},
        {"no shape", with("", kShape, R"({"name": "b"})"), {"/bodies/0/shape: is missing"}},
        {"unknown shape", with("", kShape, R"({"name": "b", "shape": "t"})"), {"/bodies/0/shape: unknown shape \"t\""}},
        {"misspelt shape",
         with("", R"({"name": "crate", "mass": 1, )" + kSurface + "}", R"({"name": "b", "shape": "crates"})"),
         {"/bodies/0/shape: unknown shape \"crates\"; did you mean \"crate\"?"}},
        {"dynamic without mass",
         shape(""),
         {"/bodies/0/shape: shape \"s\" has no mass: a dynamic body needs surface_density, density, line_density or "
          "mass"}},
        {"unknown type",
         body(R"("type": "fixed")"),
         {"/bodies/0/type: unknown body type \"fixed\" (dynamic, static, kinematic)"}},
        {"rotation not of unit length",
         body(R"("rotation": [1.00001, 0, 0, 0])"),
         {"/bodies/0/rotation: must be a unit quaternion [w, x, y, z]; its length is 1.00001, more than 1e-06 from 1"}},
        {"rotation zero",
         body(R"("rotation": [0, 0, 0, 0])"),
         {"/bodies/0/rotation: must be a unit quaternion [w, x, y, z]; its length is 0, more than 1e-06 from 1"}},
        {"rotation as 3 angles",
         body(R"("rotation": [0, 0, 90])"),
         {"/bodies/0/rotation: must be an array of 4 numbers [w, x, y, z], got an array of 3"}},
        {"huge position",
         body(R"("position": [1e12, 0, 0])"),
         {"/bodies/0/position: component 1e+12 exceeds the limit of 1e+09 m"}},
        {"huge velocity",
         body(R"("velocity": [0, -1e300, 0])"),
         {"/bodies/0/velocity: component 1e+300 exceeds the limit of 1e+09 m/s"}},
        {"huge angular velocity",
         body(R"("angular_velocity": [0, 1e7, 0])"),
         {"/bodies/0/angular_velocity: component 1e+07 exceeds the limit of 1e+06 rad/s"}},
        {"negative friction", body(R"("friction": -0.1)"), {"/bodies/0/friction: must be in 0 .. 1000, got -0.1"}},
        {"restitution above 1", body(R"("restitution": 1.1)"), {"/bodies/0/restitution: must be in 0 .. 1, got 1.1"}},
        {"static with a velocity",
         body(R"("type": "static", "velocity": [1,0,0])"),
         {"/bodies/0/velocity: must be zero: a static body does not move"}},
        {"two bad bodies",
         with("", kShape, R"({"name": "a", "shape": "s", "position": [0]}, 5)"),
         {"/bodies/0/position: must be an array of 3 numbers, got an array of 1",
          "/bodies/1: must be an object, got 5"}},
    };
}

std::vector<BadScene> bad_keyframes() {
    const std::string origin = R"("position": [0,0,0])";
    return {
        {"none", body(R"("type": "kinematic")"), {"/bodies/0/keyframes: a kinematic body needs at least one keyframe"}},
        {"of a dynamic body",
         body(R"("keyframes": [{"time": 0, )" + origin + "}]"),
         {"/bodies/0/keyframes: only a kinematic body has keyframes"}},
        {"with a velocity",
         body(R"("type": "kinematic", "angular_velocity": [1,0,0], "keyframes": [{"time": 0, )" + origin + "}]"),
         {"/bodies/0/angular_velocity: must be zero: a kinematic body moves by its keyframes"}},
        {"first one late",
         keyframes(R"({"time": 1, )" + origin + "}"),
         {"/bodies/0/keyframes/0/time: the first keyframe must be at time 0, got 1"}},
        {"out of order",
         keyframes(R"({"time": 0, )" + origin + R"(}, {"time": 2, )" + origin + R"(}, {"time": 2, )" + origin + "}"),
         {"/bodies/0/keyframes/2/time: must be later than the keyframe before, 2 s; got 2 s"}},
        {"negative time",
         keyframes(R"({"time": -1, )" + origin + "}"),
         {"/bodies/0/keyframes/0/time: must be in 0 .. 1e+09 s, got -1"}},
        {"no position", keyframes(R"({"time": 0})"), {"/bodies/0/keyframes/0/position: is missing"}},
        {"unknown key",
         keyframes(R"({"time": 0, "rotaton": [1,0,0,0], )" + origin + "}"),
         {"/bodies/0/keyframes/0/rotaton: unknown key \"rotaton\"; did you mean \"rotation\"?"}},
        {"bad rotation",
         keyframes(R"({"time": 0, "rotation": [2,0,0,0], )" + origin + "}"),
         {"/bodies/0/keyframes/0/rotation: must be a unit quaternion [w, x, y, z]; its length is 2, more than 1e-06 "
          "from 1"}},
        {"other start",
         body(R"("type": "kinematic", "position": [1,0,0], "keyframes": [{"time": 0, )" + origin + "}]"),
         {"/bodies/0/position: differs from the keyframe at time 0, which is the start of a kinematic body"}},
    };
}

// Meshes whose mass does not exist, and meshes that are not there.
std::vector<BadScene> bad_masses() {
    return {
        {"no area",
         surface(R"("vertices": [[0,0,0],[1,0,0],[2,0,0]], "triangles": [[0,1,2]])"),
         {"/shapes/0: shape 's': its surface area is zero: all its triangles are degenerate"}},
        {"density of an open mesh",
         shape(R"("density": 5)"),
         {"/shapes/0: shape 's': a density needs a closed mesh, this one has a boundary, edges of an odd number of "
          "triangles (use surface_density or mass)"}},
        {"inertia not positive",
         shape(R"("mass": 1, "inertia": [1, 1, -1])"),
         {"/shapes/0: shape 's': inertia must be positive definite"}},
        {"inertia of no body",
         shape(R"("mass": 1, "inertia": [1, 1, 5])"),
         {"/shapes/0: shape 's': inertia is impossible: the largest principal value exceeds the sum of the other two"}},
        {"missing mesh file",
         surface(R"("mesh": "/no/such/mesh.obj")"),
         {"/shapes/0/mesh: cannot read /no/such/mesh.obj: No such file or directory"}},
        {"mesh of an unknown format",
         surface(R"("mesh": "/no/such/mesh.xyz")"),
         {"/shapes/0/mesh: /no/such/mesh.xyz:1: unknown mesh format '.xyz', known are .obj, .stl, .ply, .gltf and "
          ".glb"}},
    };
}

BadScene several_problems() {
    return {"several problems",
            R"({"flotilla_scene": 1, "gravity": 9.8, "settings": {"friction": -1},
                "shapes": [{"name": "s", "mass": "heavy", )" +
                kSurface + R"(}],
                "bodies": [{"name": "b", "shape": "s", "position": [0, 0], "mass": 1},
                           {"name": "b", "shape": "q", "type": 3}, 5]})",
            {"/gravity: must be an array of 3 numbers, got 9.8", "/settings/friction: must be in 0 .. 1000, got -1",
             "/shapes/0/mass: must be a number, got the string \"heavy\"", "/bodies/0/mass: unknown key \"mass\"",
             "/bodies/0/position: must be an array of 3 numbers, got an array of 2",
             "/bodies/1/shape: unknown shape \"q\"", "/bodies/1/type: must be a string, got 3",
             "/bodies/2: must be an object, got 5", "/bodies/1/name: \"b\" is already the name of /bodies/0"}};
}

} // namespace

std::vector<BadScene> bad_scenes() {
    std::vector<BadScene> all;
    const auto append = [&](const std::string& group, std::vector<BadScene> scenes) {
        for (BadScene& scene : scenes) {
            scene.kind = group + ": " + scene.kind;
            all.push_back(std::move(scene));
        }
    };
    append("text", bad_text());
    append("top", bad_top());
    append("shape", bad_shapes());
    append("mass", bad_masses());
    append("body", bad_bodies());
    append("keyframes", bad_keyframes());
    append("all", {several_problems()});
    return all;
}

std::vector<std::string> good_scenes() {
    return {top(""), shape("\"mass\": 1"), surface(kSurface), body("\"friction\": 1"),
            keyframes(R"({"time": 0, "position": [0,0,0]})")};
}

} // namespace flotilla::test
