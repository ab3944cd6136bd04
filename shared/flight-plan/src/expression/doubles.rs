//! Whole numbers that were written beside doubles: what they should be.

use super::{ExpressionError, Operator, Type, mentioned};
use crate::Id;
use cel::common::ast::{Expr, IdedExpr, LiteralValue, operators};

/// The error of an operator's operands, with the correction that there is where a whole number was written beside a double.
pub(super) fn corrected(
    error: ExpressionError,
    source: &str,
    operator: Operator,
    operands: [(&IdedExpr, Type); 2],
) -> ExpressionError {
    let whole = match operands {
        [(whole, Type::Int), (_, Type::Number)] | [(_, Type::Number), (whole, Type::Int)] => whole,
        _ => return error,
    };
    // a remainder is of whole numbers only
    let written = written(whole).filter(|_| operator != Operator::Remainder);
    let Some(from) = written.filter(|from| !mentioned(source, &|word: &str| word == from).is_empty()) else {
        return error;
    };
    let message = format!("write {from}.0 instead of {from}: both operands must be doubles");
    let correction = Some(Box::new((Id::new(&from), Id::new(&format!("{from}.0")))));
    ExpressionError { message, correction, ..error }
}

/// The digits of a number, without its sign.
fn written(whole: &IdedExpr) -> Option<String> {
    let number = match &whole.expr {
        Expr::Call(call) if call.func_name == operators::NEGATE => call.args.first()?,
        _ => whole,
    };
    match &number.expr {
        Expr::Literal(LiteralValue::Int(number)) => Some(number.inner().unsigned_abs().to_string()),
        _ => None,
    }
}
