# What nanobind's signatures cannot say in the type stubs (nanobind's pattern file).

# The controller's class follows from its kind.
robocell._core.Robot.set_controller:
    \from typing import Literal
    @overload
    def set_controller(self, group: str, kind: Literal["joint_impedance"]) -> JointImpedanceController:
        \doc
    @overload
    def set_controller(self, group: str, kind: Literal["cartesian_impedance"]) -> CartesianImpedanceController: ...
    @overload
    def set_controller(self, group: str, kind: Literal["cartesian_pose"]) -> CartesianPoseController: ...
    @overload
    def set_controller(self, group: str, kind: str) -> Controller: ...

