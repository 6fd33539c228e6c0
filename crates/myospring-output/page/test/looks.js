// The looks in which pages are checked.

/**
 * Whether a look is left out unless all cases are asked for, as by `cargo xtask test --full`: each width and each scheme stays once.
 *
 * @param {"light" | "dark"} colorScheme
 * @param {number} width
 */
export const leavesOut = (colorScheme, width) => process.env.MYOSPRING_ALL_CASES === undefined && (colorScheme === "dark") === (width > 1000);
