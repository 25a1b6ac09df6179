#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plants violations and expects scripts/check_sources.py to name each of them: one in a copy of the real sources, and one of
every kind in an empty tree."""
import contextlib
import io
import os
import shutil
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
sys.dont_write_bytecode = True
import check_sources  # noqa: E402  (the path comes first)

LICENCE = "// SPDX-License-Identifier: MIT\n"


class CheckSources(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copy(os.path.join(ROOT, "CMakeLists.txt"), self.folder)
        os.makedirs(os.path.join(self.folder, "scripts", "cmake"))
        shutil.copy(os.path.join(ROOT, check_sources.NOTICE), os.path.join(self.folder, "scripts", "cmake"))

    def copy_sources(self):
        for name in [".ci", "include", "scripts", "src"]:
            shutil.copytree(os.path.join(ROOT, name), os.path.join(self.folder, name), dirs_exist_ok=True)

    def check(self):
        violations = check_sources.check_tree(self.folder)
        return 1 if violations else 0, "\n".join(violations)

    def plant(self, path, text):
        path = os.path.join(self.folder, path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def expect_refused(self, path, line):
        self.plant(path, LICENCE + line + "\n")
        code, output = self.check()
        self.assertEqual(code, 1, output)
        self.assertIn(path + ":2: ", output)

    def expect_accepted(self, path, line):
        self.plant(path, LICENCE + line + "\n")
        code, output = self.check()
        self.assertEqual(code, 0, output)

    def test_long_lines(self):
        self.expect_refused("src/base/a.hpp", "// " + 118 * "x")
        self.expect_accepted("src/base/a.hpp", "// " + 117 * "x")
        self.expect_refused("include/flotilla/a.hpp", "// " + 118 * "x")
        self.expect_accepted("include/flotilla/a.hpp", "// " + 117 * "x")
        self.expect_accepted("tests/base/a.cpp", "// " + 118 * "x")

    def test_finds_a_violation_among_the_real_sources(self):
        self.copy_sources()
        self.assertEqual(self.check(), (0, ""))
        self.plant("src/base/planted.hpp", LICENCE + '#include "geometry/closest.hpp"\n')
        with contextlib.redirect_stdout(io.StringIO()) as output:
            self.assertEqual(check_sources.main([self.folder]), 1)
        self.assertEqual(output.getvalue(), 'src/base/planted.hpp:2: base may not include "geometry/closest.hpp"\n')

    def test_names_a_library_that_the_notice_leaves_out(self):
        self.plant("src/io/planted.cpp", LICENCE + "#include <hdf5.h>\n#include <CLI/CLI.hpp>\n")
        self.plant(check_sources.NOTICE, "CLI11 and Eigen\n")
        self.assertEqual(list(check_sources.check_notice(self.folder)),
                         ["scripts/cmake/NOTICE.txt: does not name hdf5, which sources include"])

    def test_refuses_an_include_against_the_data_flow(self):
        self.expect_refused("src/base/planted.hpp", '#include "geometry/closest.hpp"')

    def test_refuses_siblings(self):
        self.expect_refused("src/failsafe/planted.cpp", '#include "collision/collision.hpp"')

    def test_permissions_are_transitive(self):
        self.expect_accepted("src/state/planted.cpp", '#include "geometry/closest.hpp"\n#include "base/vec3.hpp"')

    def test_a_prefix_permits_only_headers_that_start_with_it(self):
        self.expect_accepted("src/proximity/planted.cpp", '#include "ccd/feature_candidates.hpp"')
        self.expect_refused("src/proximity/planted.cpp", '#include "ccd/earliest_hit.hpp"')
        self.expect_refused("src/run_folder/planted.cpp", '#include "step/stepper.hpp"')

    def test_the_audit_shares_no_collision_detection(self):
        for header in ("geometry/exact/triangle.hpp", "mesh/placement.hpp", "mesh/triangle_mesh.hpp", "base/rotation.hpp",
                       "parallel/parallel_for.hpp"):
            self.expect_accepted("src/audit/planted.cpp", f'#include "{header}"')
        for header in ("geometry/ccd.hpp", "geometry/closest.hpp", "mesh/bvh.hpp", "state/trajectories.hpp",
                       "state/candidate_pairs.hpp", "scene/scene.hpp", "parallel/team.hpp"):
            self.expect_refused("src/audit/planted.cpp", f'#include "{header}"')
        self.expect_refused("src/audit/planted.cpp", "#include <flotilla/scene.hpp>")

    def test_the_step_does_not_use_its_proof(self):
        self.expect_accepted("src/run/planted.cpp", '#include "audit/audit.hpp"')
        self.expect_refused("src/step/planted.cpp", '#include "audit/audit.hpp"')

    def test_the_command_sees_public_headers_only(self):
        self.expect_accepted("src/cli/planted.cpp", "#include <flotilla/scene.hpp>")
        self.expect_refused("src/cli/planted.cpp", '#include "base/vec3.hpp"')

    def test_a_module_may_not_use_public_headers_above_it(self):
        self.expect_accepted("src/geometry/planted.cpp", "#include <flotilla/types.hpp>")
        self.expect_refused("src/geometry/planted.cpp", "#include <flotilla/scene.hpp>")

    def test_the_core_knows_no_files_of_runs(self):
        for library in ("hdf5.h", "png.h", "zlib.h"):
            self.expect_refused("src/io/planted.cpp", f"#include <{library}>")
        self.expect_accepted("src/io/planted.cpp", "#include <flotilla/scene_file.hpp>")
        self.expect_accepted("src/run_folder/planted.cpp", "#include <hdf5.h>\n#include <zlib.h>")
        self.expect_accepted("src/picture/planted.cpp", "#include <png.h>")
        self.expect_refused("src/api/planted.cpp", '#include "run_folder/run_folder.hpp"')
        self.expect_refused("src/api/planted2.cpp", "#include <flotilla/run.hpp>")
        self.expect_refused("include/flotilla/world.hpp", "#include <flotilla/export.hpp>")

    def test_threads_live_in_one_module(self):
        self.expect_accepted("src/parallel/planted.cpp", "#include <thread>")
        self.expect_refused("src/step/planted.cpp", "#include <oneapi/tbb/task_group.h>")
        self.expect_refused("src/step/planted.cpp", "#include <thread>")
        self.expect_refused("src/step/planted.cpp", "#pragma omp parallel for")

    def test_the_numeric_core_uses_std_and_eigen_only(self):
        self.expect_accepted("src/io/planted.cpp", "#include <nlohmann/json.hpp>")
        self.expect_accepted("src/mesh/planted.cpp", "#include <Eigen/Core>")
        self.expect_refused("src/mesh/planted.cpp", "#include <nlohmann/json.hpp>")

    def test_public_headers_use_std_only(self):
        self.expect_refused("include/flotilla/planted.hpp", "#include <Eigen/Core>")
        self.expect_refused("include/flotilla/planted.hpp", '#include "base/vec3.hpp"')

    def test_refuses_includes_relative_to_the_file_and_unknown_modules(self):
        self.expect_refused("src/mesh/planted.cpp", '#include "triangle_mesh.hpp"')
        self.plant("src/misc/planted.cpp", LICENCE)
        self.assertIn("src/misc/planted.cpp:1: ", self.check()[1])

    def test_every_source_script_and_cmake_file_carries_the_licence(self):
        for path in ["src/base/planted.cpp", "tests/planted.py", "scripts/cmake/Planted.cmake", "bench/x/CMakeLists.txt"]:
            self.plant(path, "\n")
            self.assertIn(path + ":1: ", self.check()[1])
        self.plant("scripts/planted", "#!/bin/sh\n")
        self.assertIn("scripts/planted:1: ", self.check()[1])


if __name__ == "__main__":
    unittest.main()
