//! How much room each problem takes in the list.

/// How a problem is listed until it is opened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lines {
    /// Of its headline.
    pub most: usize,
    /// Its remedy stands beside it: below it takes the room of the next problem.
    pub is_beside: bool,
}

/// Where there are more problems than a few, all of them are to be seen at once, in two lines each if these fit the room, screen points.
pub fn lines(problems: usize, room: f32) -> Lines {
    let is_beside = problems > FEW;
    let fit = problems as f32 * (TWO_LINES + BETWEEN) <= room;
    Lines { most: if is_beside && !fit { 1 } else { ROWS }, is_beside }
}

/// Of a problem, where there is room.
const ROWS: usize = 2;
/// So many take all the room that they want.
const FEW: usize = 3;
/// Height of a problem in two lines, screen points.
const TWO_LINES: f32 = 30.0;
/// Between such, screen points.
pub const BETWEEN: f32 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_problems_take_two_lines_each_where_there_is_room() {
        assert_eq!(lines(3, 0.0), Lines { most: 2, is_beside: false });
        assert_eq!(lines(4, 136.0), Lines { most: 2, is_beside: true });
        assert_eq!(lines(9, 136.0), Lines { most: 1, is_beside: true });
    }
}
