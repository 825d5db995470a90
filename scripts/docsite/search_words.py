"""How the search of the site ranks pages: what people type for a page, which folders come first.

The words go into the search index as tags of the page, which count more than its title.
"""

from __future__ import annotations

# By the first part of the path: what a reader wants to do comes before the reference.
BOOST = {
    "howto": 4, "tutorials": 4, "troubleshooting.md": 2, "notebooks": 0.5, "reference": 0.4,
    "spec_fields.md": 0.4, "decisions": 0.1, "files": 0.05,
}  # fmt: skip
# For each page words that it does not have in its title.
WORDS = {
    "tutorials/get_started.md": ["install", "first steps", "demo", "quick start"],
    "tutorials/own_robot.md": [
        "add my own new custom robot",
        "import",
        "robot yaml file",
        "mjcf",
        "ur5e",
        "ur10e",
        "ur",
        "arm",
        "menagerie",
        "bring",
    ],
    "tutorials/first_dataset.md": ["generate", "record demonstrations", "make data"],
    "tutorials/own_task.md": [
        "write",
        "custom",
        "define",
        "create",
        "make",
        "add new task",
        "reward success",
        "goal",
    ],
    "tutorials/rl_environments.md": ["gymnasium", "gym", "reinforcement learning", "ppo", "sb3"],
    "tutorials/train_and_evaluate.md": ["learn", "policy", "imitation", "behaviour cloning"],
    "tutorials/two_arms.md": ["bimanual", "dual arm", "several robots"],
    "tutorials/ten_lines.md": ["hello world", "move joints", "first program"],
    "howto/change_scene.md": ["spawn", "delete", "insert"],
    "howto/evaluate_policy.md": ["success rate"],
    "howto/benchmark.md": ["compare", "leaderboard", "frozen", "reproduce"],
    "howto/train_lerobot.md": ["act", "diffusion", "smolvla", "lerobot-train", "lerobot-eval"],
    "import.md": ["convert", "load lerobot", "robomimic", "aloha", "zarr"],
    "howto/from_urdf.md": ["import urdf", "convert", "xacro", "ur5e", "ur10e"],
    "howto/limit_motion.md": [
        "max_relative_movement",
        "unit units of actions",
        "step limit",
        "speed",
        "safety",
    ],
    "grasps.md": ["grasping", "antipodal", "graspnet", "suction", "npz", "handle", "rim"],
    "motion.md": ["motion planning", "rrt", "collision avoidance", "obstacle", "moveit", "ompl"],
    "howto/move_to_pose.md": ["inverse kinematics", "ik", "cartesian", "end-effector", "tcp"],
    "howto/read_without_robocell.md": ["h5py", "hdf5", "open", "load"],
    "howto/record_depth.md": ["record depth images", "camera", "save", "segmentation", "rgbd"],
    "howto/record_video.md": ["mp4", "film", "movie"],
    "howto/resume_run.md": [
        "continue",
        "interrupted",
        "restart",
        "crash",
        "crashed",
        "killed",
        "generation",
        "after",
        "shard",
    ],
    "howto/torque_mode.md": [
        "switch an arm to torque mode safely",
        "torque control",
        "effort",
        "gravity compensation",
    ],
    "generate.md": ["generate", "workers"],
    "troubleshooting.md": ["error", "problem", "fails", "help"],
    "install.md": ["pip", "wheel", "cmake", "requirements"],
}
